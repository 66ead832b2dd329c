//! The occlabel program: arguments, progress, exit codes.
