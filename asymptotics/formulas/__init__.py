"""Ring elements as formulas: normal forms, the zero test, expressions in SymPy."""
