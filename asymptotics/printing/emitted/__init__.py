"""What the emitted modules are made of: modules of order 1, which run as they stand.

:mod:`asymptotics.printing.numpy_code` and :mod:`asymptotics.printing.beam_numpy` write other orders
by putting their amplitudes in the place of these. They need NumPy only and import nothing of
ropewave.
"""
