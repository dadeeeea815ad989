"""What the user states: vertex, springs, symmetry, contact, and the files and families they come from."""
