"""The order loop, the frame of the contact point, the proof, and how expansions are kept."""
