//! Objects of a store, through the crate `object_store`.
//!
//! ```text
//!   open:  one request for the beginning, with length and version -> windows that grow as one reads on
//!   put:   one request, or the parts of a large object, which then appear as one
//!   look:  a page of the store's listing, remembered, of what will not change; else a request each
//! ```
//!
//! The store's library tries failed requests again, and goes on where a body was cut.

mod catalog;
mod connection;
mod environment;
mod errors;
mod expected;
mod object;
mod ranged_file;
mod recent;
mod upload;

pub(crate) use object::Object;

#[cfg(test)]
mod tests;
