"""``python -m lrp_jupyter`` is ``lrp``."""

from lrp_jupyter.cli import main

if __name__ == "__main__":
    main()
