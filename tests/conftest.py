"""What all tests share: this folder on the import path (for `helpers`), how hypothesis searches, signals that are heard."""

import os
import signal

from hypothesis import settings

settings.register_profile("house", deadline=None, derandomize=True)
settings.register_profile("brief", settings.get_profile("house"), max_examples=15)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "house"))

for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # what starts the tests may ignore them (`nohup`), and a process inherits it
    number = getattr(signal, name, None)
    if number is not None and signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, signal.default_int_handler if name == "SIGINT" else signal.SIG_DFL)
