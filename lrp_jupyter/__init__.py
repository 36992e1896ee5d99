"""Live programming of robot behaviour in a Jupyter notebook."""
