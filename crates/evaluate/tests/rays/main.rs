//! RayIoU and its kin, against slow statements of the same.

mod casting;
mod support;
mod vectors;
