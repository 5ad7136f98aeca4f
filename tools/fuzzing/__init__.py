"""A fuzzer of the command line: material, mutations, inputs, and the judge of how each ends."""
