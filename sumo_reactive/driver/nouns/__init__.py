"""The nouns that flow from stage to stage: frozen values, nothing that computes."""
