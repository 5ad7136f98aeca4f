"""What all tests share: this folder on the import path (for `helpers`), and how hypothesis searches."""

from hypothesis import settings

settings.register_profile("house", deadline=None, derandomize=True)
settings.load_profile("house")
