//! `describe`.
