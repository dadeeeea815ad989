"""What is posed: facets cut into convex pieces as fast as large sheets need it, and what is kept of the last states."""
