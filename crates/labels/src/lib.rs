//! Label trees on disk: npz arrays, manifest, atomic writes, resume.
