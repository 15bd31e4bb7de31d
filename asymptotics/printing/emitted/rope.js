// The rope W_tautau - W_xixi + kappa*W = -2, through order 2 in epsilon.
//
// Order 2 of this rope is written by hand; asymptotics.printing.rope_modules puts in others.
//
//   contact(tau, omega, epsilon, parameters)    x_c/x0
//   harmonics(omega, parameters)                [{n, j, re, im}], x_c/x0 = staticContactPoint
//                                               + Re sum (re + i im) epsilon^n exp(i j omega tau)
//   staticContactPoint(parameters)              x_c/x0 at rest
//
// Numbers, not arrays. All are dimensionless: omega is the angular frequency times x0/c, epsilon
// the forcing amplitude in units of Z0, tau = c t/x0; parameters is an object with the names in
// PARAMETERS. NaN is no result: at a resonance, where no static contact point is found, or where
// so much cancels that less than half the digits of the oscillation are right.
//
// Complex numbers are pairs; a complex matrix is the real one [[Re, -Im], [Im, Re]].

export const ORDER = 2;
export const PARAMETERS = ["kappa"];
const CONTACTS = 2;
const EVEN = true;
const GENERATORS = ["S1_1", "S1_2", "alpha3", "Y0_1_0", "Y2_1_0"];

const RESOLUTION = 2 ** -26;
const STEP = 3.0;
const SCAN = 0.5;
const FARTHEST = 1e3;
const MOST_STEPS = 100000;

export function contact(tau, omega, epsilon, parameters = {}) {
  const rope = atRest(parameters);
  let total = rope.place;
  for (const { n, j, re, im } of amplitudesAt(rope, omega)) {
    const phase = j * omega * tau;
    total += epsilon ** n * (re * Math.cos(phase) - im * Math.sin(phase));
  }
  return total;
}

export function staticContactPoint(parameters = {}) {
  return atRest(parameters).place;
}

export function harmonics(omega, parameters = {}) {
  return amplitudesAt(atRest(parameters), omega);
}

function amplitudesAt(rope, omega) {
  const values = generatorsAt(rope, omega);
  const sizes = {};
  for (const name of GENERATORS) sizes[name] = real(size(values[name]));
  const found = amplitudes(values, real(-1.0));
  const terms = amplitudes(sizes, real(1.0));
  return found.map(([n, j, value], index) => {
    const same = found.filter(([other]) => other === n);
    const order = same.reduce((sum, [, , x]) => sum + size(x), 0.0);
    const sure = 2 ** -48 * terms[index][2][0] <= RESOLUTION * order;
    const scale = sure ? rope.leading ** -n : NaN;
    return { n, j, re: value[0] * scale, im: value[1] * scale };
  });
}

// The amplitudes, complex numbers as pairs; with magnitudes and minus = 1 the sums of the sizes.
function amplitudes(v, minus) {
  let x1_1 = mul(minus, v.S1_1);
  let x2_0 = mul(real(1 / 4), pow(v.S1_1, 2), add(mul(minus, v.alpha3), mul(minus, v.Y0_1_0)));
  x2_0 = add(x2_0, mul(real(1 / 2), v.S1_1, add(v.S1_2)));
  let x2_2 = mul(real(1 / 4), pow(v.S1_1, 2), add(mul(minus, v.alpha3), mul(minus, v.Y2_1_0)));
  x2_2 = add(x2_2, mul(real(1 / 2), v.S1_1, add(v.S1_2)));
  return [[1, 1, x1_1], [2, 0, x2_0], [2, 2, x2_2]];
}

// The coefficients of W, W_xi, ... at exp(i x tau), as pairs.
function equation(x, p) {
  return [[p.kappa - x ** 2, 0.0], [0.0, 0.0], [-1.0, 0.0]];
}

// The right-hand side's coefficients of 1, xi, ...
function load(p) {
  return [-2.0];
}

// The coefficients of W, W_xi, ... of each condition at the driven end.
function drivenEnd(x, p) {
  return [[[1.0, 0.0], [0.0, 0.0]]];
}

// What each equals at rest.
function constants(p) {
  return [1.0];
}

// The amplitude of epsilon exp(i j omega tau) in each condition.
function drive(j, p) {
  return { 1: [[1.0, 0.0]] }[j] ?? [[0.0, 0.0]];
}

// -- complex numbers ------------------------------------------------------------------------------

function real(x) {
  return [x, 0.0];
}

function size(x) {
  return Math.hypot(x[0], x[1]);
}

function add(...terms) {
  return terms.reduce((a, b) => [a[0] + b[0], a[1] + b[1]]);
}

function mul(...factors) {
  return factors.reduce((a, b) => [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]);
}

function pow(x, n) {
  return mul(...Array(n).fill(x));
}

function div(a, b) {
  const below = b[0] * b[0] + b[1] * b[1];
  return [(a[0] * b[0] + a[1] * b[1]) / below, (a[1] * b[0] - a[0] * b[1]) / below];
}

// -- small real matrices: arrays of rows ----------------------------------------------------------

function times(A, B) {
  return A.map((row) => B[0].map((_, k) => row.reduce((sum, x, i) => sum + x * B[i][k], 0.0)));
}

function unit(n) {
  return Array.from({ length: n }, (_, i) => Array.from({ length: n }, (_, k) => +(i === k)));
}

function transposed(A) {
  return A[0].map((_, k) => A.map((row) => row[k]));
}

function norm(A) {
  return Math.max(...A.map((row) => row.reduce((sum, x) => sum + Math.abs(x), 0.0)));
}

// exp of a matrix of norm about STEP at most: Taylor's series of its eighth, squared.
function exponential(A) {
  const n = A.length;
  const small = A.map((row) => row.map((x) => x / 8.0));
  let total = unit(n);
  for (let k = 16; k > 0; k--) {
    total = times(small, total).map((row, i) => row.map((x, c) => x / k + +(i === c)));
  }
  for (let k = 0; k < 3; k++) total = times(total, total);
  return total;
}

// x with A x = B by elimination with pivots, and whether A is regular to half its digits.
function solved(A, B) {
  const n = A.length;
  const rows = A.map((row, i) => [...row, ...B[i]]);
  let regular = true;
  for (let k = 0; k < n; k++) {
    let best = k;
    for (let i = k + 1; i < n; i++) {
      if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
    }
    [rows[k], rows[best]] = [rows[best], rows[k]];
    if (!(Math.abs(rows[k][k]) > RESOLUTION)) regular = false;
    for (let i = 0; i < n; i++) {
      if (i === k) continue;
      const ratio = rows[i][k] / rows[k][k];
      for (let c = k; c < rows[i].length; c++) rows[i][c] -= ratio * rows[k][c];
    }
  }
  return { x: rows.map((row, i) => row.slice(n).map((x) => x / row[i])), regular };
}

function determinant(A) {
  const rows = A.map((row) => [...row]);
  let product = 1.0;
  for (let k = 0; k < rows.length; k++) {
    let best = k;
    for (let i = k + 1; i < rows.length; i++) {
      if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
    }
    if (best !== k) {
      [rows[k], rows[best]] = [rows[best], rows[k]];
      product = -product;
    }
    product *= rows[k][k];
    if (rows[k][k] === 0) return 0.0;
    for (let i = k + 1; i < rows.length; i++) {
      const ratio = rows[i][k] / rows[k][k];
      for (let c = k; c < rows.length; c++) rows[i][c] -= ratio * rows[k][c];
    }
  }
  return product;
}

// Columns made orthonormal one after another, twice, with their orientation.
function orthonormal(columns) {
  const found = [];
  for (const column of columns) {
    let x = [...column];
    for (let pass = 0; pass < 2; pass++) {
      for (const y of found) {
        const inside = x.reduce((sum, value, i) => sum + value * y[i], 0.0);
        x = x.map((value, i) => value - inside * y[i]);
      }
    }
    const length = Math.hypot(...x);
    found.push(x.map((value) => value / length));
  }
  return found;
}

// -- marching from the driven end to the contact point --------------------------------------------

// One step on: the free solutions (columns) orthonormal again, the driven one orthogonal to them.
function carried(step, free, driven) {
  const moved = (x) => step.map((row) => row.reduce((sum, value, i) => sum + value * x[i], 0.0));
  const plane = orthonormal(free.map(moved));
  let state = moved(driven);
  for (const y of plane) {
    const inside = state.reduce((sum, value, i) => sum + value * y[i], 0.0);
    state = state.map((value, i) => value - inside * y[i]);
  }
  return [plane, state];
}

// An orthonormal basis of what the conditions leave free, and one state that meets them.
function atDrivenEnd(rows, amplitudes, data) {
  const sizes = rows.map((row) => Math.max(...row.map(Math.abs)) || 1.0);
  const scaled = rows.map((row, i) => row.map((x) => x / sizes[i]));
  const gram = times(scaled, transposed(scaled));
  const right = amplitudes.map((x, i) => [x / sizes[i]]);
  const driven = times(transposed(scaled), solved(gram, right).x).map((row) => row[0]);
  const inside = orthonormal(scaled);
  const free = [];
  for (const candidate of unit(rows[0].length)) {
    const rest = [...inside, ...free].reduce(
      (x, y) => {
        const part = x.reduce((sum, value, i) => sum + value * y[i], 0.0);
        return x.map((value, i) => value - part * y[i]);
      },
      candidate,
    );
    if (Math.hypot(...rest) > 1e-3) free.push(orthonormal([...inside, ...free, rest]).at(-1));
    if (free.length === data) break;
  }
  return [free, driven];
}

// The companion matrix in units of a rate, complex entries as pairs.
function companion(c) {
  const r = c.length - 1;
  const ratio = c.slice(0, r).map((x) => div(x, c[r]));
  const rate = Math.max(0.5, ...ratio.map((x, k) => size(x) ** (1 / (r - k))));
  const last = ratio.map((x, k) => x.map((part) => -part * rate ** (k - r)));
  return { last, rate, r };
}

function impedancesAt(j, omega, rope) {
  const { last, rate, r } = companion(equation(j * omega, rope.p));
  const parts = EVEN ? 1 : 2;
  const data = CONTACTS - 1;
  // State: real parts of w, w', ..., then imaginary parts.
  const A = Array.from({ length: parts * r }, () => Array(parts * r).fill(0.0));
  for (let part = 0; part < parts; part++) {
    for (let k = 0; k < r - 1; k++) A[part * r + k][part * r + k + 1] = 1.0;
    for (let k = 0; k < r; k++) {
      A[part * r + r - 1][part * r + k] = last[k][0];
      if (!EVEN) A[part * r + r - 1][(1 - part) * r + k] = part ? last[k][1] : -last[k][1];
    }
  }
  const rows = drivenEnd(j * omega, rope.p).map((row) =>
    row.map((x, k) => x.map((y) => y * rate ** k)),
  );
  const amplitudes = drive(j, rope.p);
  let E = rows.map((row) => row.map((x) => x[0]));
  let right = amplitudes.map((x) => x[0]);
  if (!EVEN) {
    E = [
      ...rows.map((row) => [...row.map((x) => x[0]), ...row.map((x) => -x[1])]),
      ...rows.map((row) => [...row.map((x) => x[1]), ...row.map((x) => x[0])]),
    ];
    right = [...right, ...amplitudes.map((x) => x[1])];
  }
  const reach = rate * rope.place * norm(A);
  const steps = Math.ceil(Math.max(1.0, reach) / STEP);
  if (!(steps <= MOST_STEPS)) return { regular: false, table: [], source: [], r };
  const step = exponential(A.map((row) => row.map((x) => (x * rate * rope.place) / steps)));
  let [free, driven] = atDrivenEnd(E, right, parts * data);
  for (let k = 0; k < steps; k++) [free, driven] = carried(step, free, driven);
  const columns = transposed(free);
  const upper = [];
  const above = [];
  for (let part = 0; part < parts; part++) {
    for (let i = 0; i < data; i++) {
      upper.push(columns[part * r + i]);
      above.push(driven[part * r + i]);
    }
  }
  // Weights of the free solutions for unit data (real ones suffice) and for the drive.
  const sides = above.map((x, i) => [
    ...Array.from({ length: data }, (_, k) => +(i === k)),
    -x,
  ]);
  const { x: weights, regular } = solved(upper, sides);
  const states = columns.map((row) =>
    weights[0].map((_, c) => row.reduce((sum, x, i) => sum + x * weights[i][c], 0.0)),
  );
  const pair = (d, c, extra) => {
    const re = states[d][c] + (extra ? driven[d] : 0.0);
    const im = EVEN ? 0.0 : states[r + d][c] + (extra ? driven[r + d] : 0.0);
    return [re, im];
  };
  const table = Array.from({ length: data }, (_, i) =>
    Array.from({ length: r }, (_, d) => pair(d, i, false).map((x) => x * rate ** (d - i))),
  );
  const source = Array.from({ length: r }, (_, d) =>
    pair(d, data, true).map((x) => x * rate ** d),
  );
  return { regular, table, source, r };
}

// Derivatives 0 ... depth - 1 from the first ones, by the equation differentiated.
function tower(c, first, depth, pull = []) {
  const found = [...first];
  const r = c.length - 1;
  while (found.length < depth) {
    const lowest = found.length - r;
    let total = real(-(pull[lowest] ?? 0.0));
    for (let k = 0; k < r; k++) total = add(total, mul(c[k], found[lowest + k]));
    found.push(div(total, mul(real(-1.0), c[r])));
  }
  return found;
}

function generatorsAt(rope, omega) {
  const depth = ORDER + CONTACTS;
  const found = {};
  for (let d = CONTACTS + 1; d < depth; d++) found[`alpha${d}`] = real(rope.tower[d] / rope.leading);
  const named = GENERATORS.filter((name) => name[0] === "S" || name[0] === "Y");
  for (const j of new Set(named.map((name) => parseInt(name.slice(1), 10)))) {
    const { regular, table, source } = impedancesAt(j, omega, rope);
    const c = equation(j * omega, rope.p);
    const lost = regular && Number.isFinite(omega) ? 0.0 : NaN;
    [...table, source].forEach((start, i) => {
      const grown = regular ? tower(c, start, depth) : Array(depth).fill(real(NaN));
      for (let d = CONTACTS - 1; d < depth - 1; d++) {
        const name = i < table.length ? `Y${j}_${d}_${i}` : `S${j}_${d}`;
        found[name] = [grown[d][0] + lost, grown[d][1]];
      }
    });
  }
  for (const name of GENERATORS) {
    if (name.endsWith("_")) {
      const [re, im] = found[name.slice(0, -1)] ?? real(NaN);
      found[name] = [re, -im];
    }
    found[name] ??= real(NaN);
  }
  return found;
}

function atRest(parameters) {
  const given = Object.keys(parameters).sort().join(", ");
  if (given !== [...PARAMETERS].sort().join(", ")) {
    throw new TypeError(`the parameters of this rope are ${PARAMETERS.join(", ")}; given: ${given}`);
  }
  const p = parameters;
  const nowhere = { p, place: NaN, leading: NaN, tower: Array(ORDER + CONTACTS).fill(NaN) };
  if (!Object.values(p).every(Number.isFinite)) return nowhere;
  const c = equation(0.0, p);
  const { last, rate, r } = companion(c);
  const polynomial = load(p);
  const q = polynomial.length;
  const n = r + q;
  const A = Array.from({ length: n }, () => Array(n).fill(0.0));
  for (let k = 0; k < r - 1; k++) A[k][k + 1] = 1.0;
  for (let k = 0; k < r; k++) A[r - 1][k] = last[k][0];
  A[r - 1][r] = 1.0;
  for (let k = 0; k < q - 1; k++) A[r + k][r + k + 1] = 1.0;
  const units = Array.from({ length: n }, (_, k) => rate ** k * (k < r ? 1.0 : c[r][0]));
  const rows = drivenEnd(0.0, p).map((row) => row.map((x, k) => x[0] * rate ** k));
  let [free, driven] = atDrivenEnd(rows, constants(p), CONTACTS - 1);
  let factorial = 1.0;
  const pulls = polynomial.map((x, k) => {
    factorial *= k || 1.0;
    return (x * factorial) / units[r + k];
  });
  free = free.map((x) => [...x, ...Array(q).fill(0.0)]);
  driven = [...driven, ...pulls];
  const meeting = (plane, state) =>
    determinant(Array.from({ length: CONTACTS }, (_, i) => [...plane.map((x) => x[i]), state[i]]));
  const stride = SCAN / norm(A);
  const step = exponential(A.map((row) => row.map((x) => x * stride)));
  let before = meeting(free, driven);
  let done = 0.0;
  for (let k = 0; k < MOST_STEPS && done < FARTHEST * rate; k++) {
    const [plane, state] = carried(step, free, driven);
    const after = meeting(plane, state);
    if (before * after <= 0) {
      const found = root(A, free, driven, stride, meeting);
      if (found.state[CONTACTS] * (-1) ** CONTACTS > 0) {
        const values = found.state.map((x, i) => x * units[i]);
        const pull = values.slice(r);
        const first = values.slice(0, r).map(real);
        const grown = tower(c, first, ORDER + CONTACTS, pull).map((x) => x[0]);
        return { p, place: (done + found.at) / rate, leading: grown[CONTACTS], tower: grown };
      }
    }
    [free, driven, before] = [plane, state, after];
    done += stride;
  }
  return nowhere;
}

// The zero of the meeting determinant within a step, and the state there.
function root(A, free, driven, stride, meeting) {
  const columns = transposed([...free, driven]);
  const terms = [columns];
  for (let k = 1; k < 24; k++) {
    terms.push(times(A, terms.at(-1)).map((row) => row.map((x) => x / k)));
  }
  const at = (t) =>
    terms.reduceRight((sum, term) => sum.map((row, i) => row.map((x, c) => x * t + term[i][c])));
  const split = (t) => {
    const all = transposed(at(t));
    return [all.slice(0, -1), all.at(-1)];
  };
  const value = (t) => meeting(...split(t));
  let [low, high] = [0.0, stride];
  let [fLow, fHigh] = [value(low), value(high)];
  for (let k = 0; k < 200 && high - low > 4e-16 * stride; k++) {
    const slope = fHigh !== fLow ? fHigh - fLow : 1.0;
    const t = Math.min(Math.max(high - (fHigh * (high - low)) / slope, low), high);
    const f = value(t);
    if (f === 0) {
      low = high = t;
    } else if (f * fHigh > 0) {
      [high, fHigh, fLow] = [t, f, 0.5 * fLow];
    } else {
      [low, fLow, fHigh] = [t, f, 0.5 * fHigh];
    }
  }
  const t = Math.abs(value(low)) < Math.abs(value(high)) ? low : high;
  const [plane, state] = split(t);
  // The weights that make the first CONTACTS derivatives vanish, by least squares.
  const upper = plane.map((x) => x.slice(0, CONTACTS));
  const gram = times(upper, transposed(upper));
  const side = times(upper, state.slice(0, CONTACTS).map((x) => [x]));
  const weights = solved(gram, side).x;
  const there = state.map((x, i) => x - plane.reduce((sum, y, k) => sum + y[i] * weights[k][0], 0.0));
  for (let i = 0; i < CONTACTS; i++) there[i] = 0.0;
  return { at: t, state: there };
}
