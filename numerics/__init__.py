"""Independent numerics: never imports the algebra it is there to check.

**The string without bending, exactly.** ``characteristics`` (from rest, any Z(τ); with ``_orbits``,
``_search``), ``characteristics_thresholds`` (many Ω and ε at once; compiled in ``_kernels``),
``invariant_circle`` (the periodic state; with ``circle_newton``, ``circle_state``).

**The rope in contact.** ``drive`` → ``problem`` → ``semi_discrete`` (nodes and forces) →
``trapezoidal`` or ``verlet`` (a step; ``observables`` reads it) → ``contact`` (the simulator) →
``simulation`` (a run and what is kept of it). ``penalty`` is the same rope for
``scipy.integrate.solve_ivp``.

**What happens in it.** ``events``, ``event_study``, ``waves``, ``pulses``; ``ramped_run`` →
``threshold``; ``grazing``.

**What it must agree with.** ``exact_solutions``: ``exact_rest``, ``exact_pulse``, ``exact_bar``,
``exact_impact``.

**Files and many runs.** ``files``, ``run_files``, ``checkpoint``, ``sweep``.

Everything is in units of Z₀ (heights), x₀ (places) and x₀/c (times), x₀² = 2TZ₀/(ρg), c² = T/ρ.
"""
