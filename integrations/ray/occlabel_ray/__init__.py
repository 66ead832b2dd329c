"""Labels the scenes of a log on a Ray cluster.

A scene is the unit of work and of failure: one run of ``occlabel label --shard I/N``, which writes
its own manifest last. This package decides who labels what when, and nothing about labels.
"""
