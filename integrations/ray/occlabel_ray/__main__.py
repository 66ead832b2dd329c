"""``python -m occlabel_ray`` is the command ``occlabel-ray``."""

import sys

from occlabel_ray.command import main

sys.exit(main())
