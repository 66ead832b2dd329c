//! Objects that appear whole.

use std::io::{self, ErrorKind, Read};

use object_store::path::Path as Key;
use object_store::{
    Error, ObjectStore, ObjectStoreExt, PutMode, PutOptions, PutPayload, UpdateVersion,
    WriteMultipart,
};

use super::connection::{patiently, wait_for};
use super::errors::io_error;
use super::object::Object;
use crate::storage::Put;

/// Larger objects go in parts of this, and appear once all are there. Stores want parts of at least 5 MiB.
const PART_BYTES: usize = 8 << 20;

/// Parts that are on their way at once.
const PARTS_AT_ONCE: usize = 4;

/// Gives an object its bytes.
pub(crate) fn put(object: &Object, from: &mut dyn Read, bytes: u64, how: &Put) -> io::Result<()> {
    if *how == Put::Over && bytes > PART_BYTES as u64 {
        return put_in_parts(object, from);
    }
    let mut all = Vec::with_capacity(bytes as usize);
    from.read_to_end(&mut all)?;
    let (store, key, payload) = (&*object.connection.store, &object.key, PutPayload::from(all));
    wait_for(put_at_once(store, key, &payload, how))
}

async fn put_at_once(
    store: &dyn ObjectStore,
    key: &Key,
    payload: &PutPayload,
    how: &Put,
) -> io::Result<()> {
    let options = PutOptions { mode: mode(how), ..PutOptions::default() };
    match patiently(|| store.put_opts(key, payload.clone(), options.clone())).await {
        Err(Error::NotImplemented { .. } | Error::NotSupported { .. }) => {
            put_unconditionally(store, key, payload, how).await
        }
        // An answer that was lost on its way is asked for again, and then tells of our own object.
        Err(Error::AlreadyExists { .. } | Error::Precondition { .. })
            if is_there(store, key, payload).await =>
        {
            Ok(())
        }
        Err(Error::Precondition { .. } | Error::NotFound { .. }) if *how != Put::New => {
            Err(ErrorKind::NotFound.into())
        }
        put => put.map(|_| ()).map_err(io_error),
    }
}

fn mode(how: &Put) -> PutMode {
    match how {
        Put::Over | Put::InPlaceOf(None) => PutMode::Overwrite,
        Put::New => PutMode::Create,
        Put::InPlaceOf(version) => {
            PutMode::Update(UpdateVersion { e_tag: version.clone(), version: None })
        }
    }
}

/// Where a store knows no conditions, as plain HTTP servers do: who looks first may still lose.
async fn put_unconditionally(
    store: &dyn ObjectStore,
    key: &Key,
    payload: &PutPayload,
    how: &Put,
) -> io::Result<()> {
    if *how == Put::New && store.head(key).await.is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    store.put(key, payload.clone()).await.map(|_| ()).map_err(io_error)
}

async fn is_there(store: &dyn ObjectStore, key: &Key, payload: &PutPayload) -> bool {
    let Ok(got) = store.get(key).await else { return false };
    let ours: Vec<u8> = payload.iter().flatten().copied().collect();
    got.bytes().await.is_ok_and(|bytes| bytes == ours)
}

/// On any error, the parts are given up.
fn put_in_parts(object: &Object, from: &mut dyn Read) -> io::Result<()> {
    let upload = wait_for(patiently(|| object.connection.store.put_multipart(&object.key)));
    let mut upload = WriteMultipart::new_with_chunk_size(upload.map_err(io_error)?, PART_BYTES);
    match put_parts(&mut upload, from) {
        Ok(()) => wait_for(upload.finish()).map(|_| ()).map_err(io_error),
        Err(error) => wait_for(upload.abort()).map_err(io_error).and(Err(error)),
    }
}

fn put_parts(upload: &mut WriteMultipart, from: &mut dyn Read) -> io::Result<()> {
    let mut part = vec![0; PART_BYTES];
    loop {
        let count = from.read(&mut part)?;
        if count == 0 {
            return Ok(());
        }
        let sent = wait_for(async {
            upload.wait_for_capacity(PARTS_AT_ONCE).await?;
            upload.write(&part[..count]);
            Ok(())
        });
        sent.map_err(io_error)?;
    }
}
