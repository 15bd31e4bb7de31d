"""What a run did: contacts, waves, and how sure that is."""
