"""The lab as a static web site: Python, the simulator and the notebooks run in the visitor's browser."""
