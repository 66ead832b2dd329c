//! An object is read, listed and written as a file is: against plain bytes, in a store in memory.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::sync::Arc;

use object_store::memory::InMemory;
use object_store::path::Path as Key;

use super::Object;
use super::connection::Connection;
use super::expected::MAX_AHEAD_BYTES;
use super::ranged_file::{BLOCK_BYTES, FIRST_BYTES};
use crate::storage::{Put, Storage};

fn store(has_pages: bool) -> Arc<Connection> {
    Arc::new(Connection::new(Arc::new(InMemory::new()), has_pages))
}

fn object(store: &Arc<Connection>, key: &str) -> Object {
    Object { connection: store.clone(), key: Key::parse(key).unwrap() }
}

fn put(store: &Arc<Connection>, key: &str, bytes: &[u8]) {
    object(store, key).put(&mut &*bytes, bytes.len() as u64, &Put::Over).unwrap();
}

fn read(store: &Arc<Connection>, key: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    object(store, key).open().unwrap().read_to_end(&mut bytes).unwrap();
    bytes
}

/// Bytes that differ wherever one looks.
fn noise(count: usize) -> Vec<u8> {
    (0..count as u64).map(|at| (at.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as u8).collect()
}

#[test]
fn an_object_is_read_as_a_file_from_wherever_one_jumps() {
    let (store, bytes) = (store(true), noise(23 << 20));
    put(&store, "a/large", &bytes);
    assert!(read(&store, "a/large") == bytes);
    let mut file = object(&store, "a/large").open().unwrap();
    let (mut state, mut jumps) = (1_u64, 0);
    for _ in 0..400 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let at = (state >> 33) % (bytes.len() as u64 + 10);
        let count = [3, 5_000, 70_000, 900_000][(state >> 20) as usize % 4];
        jumps += usize::from(file.seek(SeekFrom::Start(at)).unwrap() == at);
        let mut piece = Vec::new();
        file.by_ref().take(count).read_to_end(&mut piece).unwrap();
        let end = (at + count).min(bytes.len() as u64) as usize;
        assert!(piece == bytes[(at as usize).min(end)..end], "{count} bytes from {at}");
    }
    assert_eq!((jumps, file.len()), (400, bytes.len() as u64));
    assert!(file.seek(SeekFrom::Current(-(24 << 20))).is_err());
}

/// 40 MiB, and answers and bytes that a way of reading them takes.
fn large() -> (Arc<Connection>, Vec<u8>) {
    let (store, all) = (store(true), noise(40 << 20));
    put(&store, "a", &all);
    object(&store, "").expect_no_change();
    object(&store, "a").metadata().unwrap();
    (store, all)
}

fn received(store: &Connection, read: impl FnOnce()) -> [u64; 2] {
    let before = store.received();
    read();
    let after = store.received();
    [after[0] - before[0], after[1] - before[1]]
}

#[test]
fn who_reads_a_large_object_gets_it_once_in_growing_windows() {
    let (store, all) = large();
    let [answers, bytes] = received(&store, || assert!(read(&store, "a") == all));
    assert!(answers <= 20, "{answers} answers");
    assert!((40 << 20..(40 << 20) + BLOCK_BYTES).contains(&bytes), "{bytes}");
}

#[test]
fn who_knows_where_a_record_is_gets_it_in_an_answer() {
    let (store, _) = large();
    let got = received(&store, || {
        for at in (2 << 20..40 << 20).step_by(1 << 20) {
            let mut file = object(&store, "a").open().unwrap();
            file.seek(SeekFrom::Start(at)).unwrap();
            file.read_exact(&mut vec![0; 300_000]).unwrap();
        }
    });
    assert_eq!(got, [38, 38 * 300_000]);
}

#[test]
fn who_hops_through_a_large_object_gets_its_blocks_once() {
    let (store, all) = large();
    let [_, bytes] = received(&store, || {
        for _ in 0..3 {
            let mut file = object(&store, "a").open().unwrap();
            for at in (1_000..20 << 20).step_by(50_000) {
                let mut bytes = [0; 100];
                file.seek(SeekFrom::Start(at)).unwrap();
                file.read_exact(&mut bytes).unwrap();
                assert!(bytes == all[at as usize..at as usize + 100], "{at}");
            }
        }
    });
    assert!((19 << 20..22 << 20).contains(&bytes), "{bytes}");
}

#[test]
fn objects_of_every_length_around_the_windows_are_whole() {
    let store = store(true);
    let edge = FIRST_BYTES as usize;
    for length in [0, 1, edge - 1, edge, edge + 1, 3 * edge, 3 * edge + 1, 7 * edge + 1] {
        put(&store, "a", &noise(length));
        assert!(read(&store, "a") == noise(length), "{length}");
    }
    let absent = object(&store, "b").open().unwrap_err();
    assert_eq!(absent.kind(), ErrorKind::NotFound);
}

/// Half of one and half of another would be labelled as if it were a sweep.
#[test]
fn an_object_that_is_replaced_while_it_is_read_ends_in_an_error() {
    let store = store(true);
    put(&store, "a", &noise(9 << 20));
    let mut file = object(&store, "a").open().unwrap();
    file.read_exact(&mut [0; 1000]).unwrap();
    put(&store, "a", &vec![0; 9 << 20]);
    assert!(file.read_to_end(&mut Vec::new()).is_err());
}

#[test]
fn a_new_object_is_put_once_and_a_version_is_replaced_once() {
    let store = store(true);
    let lock = object(&store, "lock");
    let put = |text: &[u8], how: &Put| lock.put(&mut &*text, text.len() as u64, how);
    put(b"one", &Put::New).unwrap();
    put(b"one", &Put::New).expect("its answer may have been lost");
    assert_eq!(put(b"two", &Put::New).unwrap_err().kind(), ErrorKind::AlreadyExists);
    let version = lock.open().unwrap().version().map(str::to_owned);
    assert!(version.is_some());
    put(b"two", &Put::InPlaceOf(version.clone())).unwrap();
    let late = put(b"three", &Put::InPlaceOf(version)).unwrap_err();
    assert_eq!((late.kind(), read(&store, "lock")), (ErrorKind::NotFound, b"two".to_vec()));
    lock.remove().unwrap();
    lock.remove().expect("gone is gone");
}

#[test]
fn what_is_large_goes_in_parts_and_appears_whole() {
    let (store, bytes) = (store(true), noise((27 << 20) + 3));
    put(&store, "a", &bytes);
    assert!(read(&store, "a") == bytes);
}

/// Names that sort around the `/` of a folder.
fn tree() -> BTreeMap<String, usize> {
    let sweeps = (0..2500).map(|at| format!("log/sweeps/TOP/s-{at:05}.bin"));
    let around = ["log/a", "log/a-b/x", "log/a.b", "log/a/x", "log/a/y/z", "log/a0", "log/t.json"];
    let outside = ["a", "lof", "log-b/x", "log0", "z"];
    let names = around.iter().chain(&outside).map(|name| (*name).to_owned());
    names.chain(sweeps).enumerate().map(|(at, name)| (name, at % 7)).collect()
}

#[test]
fn what_does_not_change_is_remembered_as_it_is() {
    for has_pages in [true, false] {
        let (store, tree) = (store(has_pages), tree());
        tree.iter().for_each(|(name, bytes)| put(&store, name, &noise(*bytes)));
        object(&store, "log").expect_no_change();
        let mut asked: Vec<String> = tree.keys().cloned().collect();
        asked.extend(tree.keys().map(|name| format!("{name}x")));
        asked.extend(tree.keys().map(|name| name[..name.len() - 1].trim_end_matches('/').into()));
        asked
            .extend(["log", "log/sweeps", "log/sweeps/TOP", "log/a/y", "log/b"].map(str::to_owned));
        let mut found = [0; 3];
        for name in asked.iter().filter(|name| !name.is_empty()) {
            let metadata = object(&store, name).metadata();
            let is_folder = tree
                .range(format!("{name}/")..)
                .next()
                .is_some_and(|(next, _)| next.starts_with(&format!("{name}/")));
            match (tree.get(name), metadata) {
                (Some(bytes), Ok(known)) => {
                    assert_eq!((known.is_file(), known.bytes()), (true, *bytes as u64), "{name}");
                    found[0] += 1;
                }
                (None, Ok(known)) => {
                    assert!(known.is_dir() && is_folder, "{name}");
                    found[1] += 1;
                }
                (None, Err(error)) => {
                    assert!(error.kind() == ErrorKind::NotFound && !is_folder, "{name}: {error}");
                    found[2] += 1;
                }
                (Some(_), Err(error)) => panic!("{name}: {error}"),
            }
        }
        assert!(found[0] > 2500 && found[1] >= 4 && found[2] > 2500, "{found:?}");
    }
}

#[test]
fn a_folder_lists_its_objects_and_folders() {
    let store = store(true);
    tree().iter().for_each(|(name, bytes)| put(&store, name, &noise(*bytes)));
    let mut names: Vec<_> = object(&store, "log")
        .list()
        .unwrap()
        .into_iter()
        .map(|(name, of)| (name, of.is_dir()))
        .collect();
    names.sort();
    let expected = [
        ("a", false),
        ("a", true),
        ("a-b", true),
        ("a.b", false),
        ("a0", false),
        ("sweeps", true),
        ("t.json", false),
    ];
    assert_eq!(names, expected.map(|(name, is_folder)| (name.to_owned(), is_folder)));
    assert_eq!(object(&store, "absent").list().unwrap_err().kind(), ErrorKind::NotFound);
}

/// Two who read in two places of the order, and one who reads what was not expected.
#[test]
fn what_is_expected_is_what_is_there_in_whatever_order_it_is_read() {
    let store = store(true);
    let sizes: Vec<usize> =
        (0..60).map(|at| [700_000, 0, 5, 9 << 20][at % 4] / (at / 20 + 1)).collect();
    let names: Vec<String> = (0..60).map(|at| format!("log/{at}")).collect();
    for (name, size) in names.iter().zip(&sizes) {
        put(&store, name, &noise(*size));
    }
    let of_order = |from: usize, to: usize| -> Vec<(String, u64)> {
        (from..to).map(|at| (at.to_string(), sizes[at] as u64)).collect()
    };
    let expect = |order: &[(String, u64)]| {
        object(&store, "log").expect(&mut order.iter().map(|(name, bytes)| (&**name, *bytes)));
    };
    expect(&of_order(0, 40));
    let mut fetched_ahead = 0;
    for at in (0..20).flat_map(|at| [at, at + 20]).chain(40..60) {
        if at == 40 {
            expect(&of_order(30, 60));
        }
        assert!(read(&store, &names[at]) == noise(sizes[at]), "{at}");
        let expected = store.expected.lock().unwrap();
        fetched_ahead += expected.count();
        assert!(expected.bytes() <= MAX_AHEAD_BYTES);
    }
    assert!(fetched_ahead > 100, "{fetched_ahead}");
    let expected = store.expected.lock().unwrap();
    assert_eq!((expected.count(), expected.bytes()), (0, 0), "all was read");
}
