"""Independent numerics: never imports the algebra it is there to check.

===================  =============================================================================
``problems``         the rope and its drives, stated independently
``exact_string``     the string without bending: ``characteristics`` from rest, for any Z(τ);
                     ``thresholds``, many Ω and ε at once; ``invariant_circle``, the periodic state
``exact_solutions``  what the simulator must agree with
``periodic``         periodic states of any linear rope, by modes or by collocation
``simulation``       ``semi_discrete`` (nodes and forces) → ``trapezoidal`` or ``verlet`` (a step,
                     read by ``observables``) → ``contact`` (the simulator) → ``run`` (what is kept
                     of it); ``penalty`` is the same rope for ``scipy.integrate.solve_ivp``
``files``            runs and checkpoints on disk
``events``           what a run did: contacts, waves
``thresholds``       where the wave-less state is lost
``sweeps``           many runs on many cores
===================  =============================================================================

A room imports those above it, never those below (import-linter holds it).

Everything is in units of Z₀ (heights), x₀ (places) and x₀/c (times), x₀² = 2TZ₀/(ρg), c² = T/ρ.
"""
