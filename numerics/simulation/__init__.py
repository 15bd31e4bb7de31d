"""The rope in contact, in time: nodes and forces, two integrators, a run."""
