"""The paper's Fig. 2, computed anew."""
