"""A competitor that is never made."""

import time

time.sleep(1e6)


class Asleep:
    pass
