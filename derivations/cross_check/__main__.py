"""``python -m derivations.cross_check``: the closed forms' errors against ε, drawn."""

from derivations.cross_check.ladder import main

if __name__ == "__main__":
    main()
