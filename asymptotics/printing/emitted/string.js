// Rope with a moving contact, string limit (beta = 0), through order 1 in epsilon.
//
// Order 1 is written by hand; asymptotics.printing.javascript puts in the amplitudes of the others.
//
//   contact(tau, omega, epsilon)      x_c/x0
//   profile(s, tau, omega, epsilon)   w/Z0 at s = (x - x_c)/x0 <= 0; 0 on the ground, s > 0
//
// Numbers, not arrays; all dimensionless: omega is the angular frequency times x0/c, epsilon the
// forcing amplitude in units of Z0, tau = c t/x0. NaN is no result: at a resonance
// omega = p pi/q, q <= ORDER, or so near that less than half the digits of cot(q omega) are right;
// where omega is not positive, too small or beyond 2**20; behind the driven end; where the series
// overflows.

export const ORDER = 1;

// The highest power of omega in an amplitude.
const POWER = 1;

const EPSILON = 2 ** -52;
const RESOLUTION = 2 ** -26;

export function contact(tau, omega, epsilon) {
  const { k, regular } = cotangents(omega);
  const place = placeOf(contactHarmonics(omega, epsilon / Math.sin(omega), k), omega * tau);
  return regular && Number.isFinite(place) ? place : NaN;
}

export function profile(s, tau, omega, epsilon) {
  const { k, regular } = cotangents(omega);
  const small = epsilon / Math.sin(omega);
  const place = placeOf(contactHarmonics(omega, small, k), omega * tau);
  if (!(regular && Number.isFinite(place) && s >= -place - RESOLUTION)) return NaN;
  const lifted = s < 0.0 ? s : 0.0 * s;
  const functions = shapeFunctions(omega * lifted);
  const cosine = cosines(omega * tau);
  let total = lifted * lifted;
  for (const [j, m, kind, amplitude] of profileAmplitudes(omega, small, k)) {
    total += amplitude * functions[m - 1][kind] * (j ? cosine[j - 1] : 1.0);
  }
  return total;
}

// [amplitude of cos(j omega tau) in x_c/x0, j = 0 ... ORDER]; o = omega, e = epsilon/sin(omega).
function contactHarmonics(o, e, k) {
  const [k1] = k;
  const h1 = e * o / 2;
  return [0.0, h1];
}

// [j, m, kind, amplitude] of cos(j omega tau) times 1 - cos(m omega s), kind 0, named v, or
// m omega s - sin(m omega s), kind 1, named d.
function profileAmplitudes(o, e, k) {
  const [k1] = k;
  const d1_1 = e;
  return [[1, 1, 1, d1_1]];
}

function placeOf(harmonics, phase) {
  const cosine = cosines(phase);
  let total = 1.0 + harmonics[0];
  for (let j = 1; j <= ORDER; j++) total += harmonics[j] * cosine[j - 1];
  return total;
}

// cot(q omega) for the number omega as it stands: what rounding q*omega lost, known after a
// splitting in two halves (Veltkamp), goes back in.
function cotangents(omega) {
  const scaled = 134217729.0 * omega;
  const high = scaled - (scaled - omega);
  const low = omega - high;
  const least = (2 ** -1022) ** (1.0 / (POWER + 1));
  let regular = omega > least && omega < 2 ** -6 / EPSILON ** 0.5;
  const k = [];
  for (let q = 1; q <= ORDER; q++) {
    const product = q * omega;
    const lost = q * high - product + q * low;
    const tangent = Math.tan(product);
    const distance = Math.abs(tangent + lost);
    const clear = distance > RESOLUTION && distance > RESOLUTION * product;
    regular = regular && (clear || product < 1.0);
    k.push((1.0 - lost * tangent) / (tangent + lost));
  }
  return { k, regular };
}

// [cos(phase), cos(2 phase), ...] by Chebyshev's recurrence.
function cosines(phase) {
  const cosine = Math.cos(phase);
  const found = [cosine];
  let before = 1.0;
  for (let j = 1; j < ORDER; j++) {
    found.push(2.0 * cosine * found[j - 1] - before);
    before = found[j - 1];
  }
  return found;
}

// [1 - cos mx, mx - sin mx] for m = 1, 2, ...: both small at small x, neither cancels.
function shapeFunctions(x) {
  const half = Math.sin(0.5 * x);
  const versine = 2.0 * half * half;
  const square = x * x;
  let series = 0.0;
  for (let k = 8; k > 0; k--) series = (1.0 - series) * square * (1.0 / ((2 * k + 1) * (2 * k)));
  const defect = Math.abs(x) < 1.0 ? x * series : x - Math.sin(x);
  const found = [[versine, defect]];
  let before = [0.0, 0.0];
  const double = 2.0 * versine;
  for (let k = 1; k < ORDER; k++) {
    const [v, g] = found[k - 1];
    found.push([
      2.0 * v - before[0] + double * (1.0 - v),
      2.0 * g - before[1] + double * (k * x - g),
    ]);
    before = [v, g];
  }
  return found;
}
