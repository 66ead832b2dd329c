//! A bucket of an S3-compatible server.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::http::{Request, body};
use crate::proxy::Proxy;
use crate::server::Server;
use crate::support::{Ended, files_under, program};

/// A bucket, and what stands between it and the program.
pub(crate) struct Bucket {
    store: u16,
    name: String,
    pub(crate) proxy: Proxy,
}

impl Bucket {
    /// An empty bucket of the one server of all tests, of which so many requests in a hundred go wrong;
    /// none if there is no server.
    pub(crate) fn new(faults_in_100: u64) -> Option<Self> {
        static SERVER: OnceLock<Option<Server>> = OnceLock::new();
        static BUCKETS: AtomicUsize = AtomicUsize::new(0);
        let server = SERVER.get_or_init(|| Server::start("s3_server.py", &[]));
        let store = server.as_ref()?.port;
        let name = format!("bucket-{}", BUCKETS.fetch_add(1, Ordering::SeqCst));
        let bucket = Self { store, name, proxy: Proxy::before(store, faults_in_100) };
        bucket.send("PUT", "", &[]);
        Some(bucket)
    }

    /// The URL of what stands there under a name.
    pub(crate) fn url(&self, name: &str) -> String {
        format!("s3://{}/{name}", self.name)
    }

    /// Puts all files of a folder into one of the bucket.
    pub(crate) fn upload(&self, folder: &Path, to: &str) {
        for (name, bytes) in files_under(folder) {
            self.put(&format!("{to}/{name}"), &bytes);
        }
    }

    /// Puts an object.
    pub(crate) fn put(&self, name: &str, bytes: &[u8]) {
        self.send("PUT", &format!("/{name}"), bytes);
    }

    /// All objects of a folder by their names in it.
    pub(crate) fn download(&self, folder: &str) -> BTreeMap<String, Vec<u8>> {
        let listed = self.send("GET", &format!("?list-type=2&prefix={folder}/"), &[]);
        let listed = String::from_utf8(listed).expect("UTF-8");
        let keys = listed.split("<Key>").skip(1).map(|rest| rest.split('<').next().unwrap());
        let named = |key: &str| {
            let name = key.strip_prefix(folder).unwrap().trim_start_matches('/');
            (name.to_owned(), self.send("GET", &format!("/{key}"), &[]))
        };
        keys.map(named).collect()
    }

    /// Runs the program, to which this is the store.
    pub(crate) fn run(&self, args: &[&str]) -> Ended {
        Ended::of(self.command(args).output().expect("the program starts"))
    }

    /// The program with these arguments, not started.
    pub(crate) fn command(&self, args: &[&str]) -> Command {
        let mut command = program();
        let endpoint = format!("http://127.0.0.1:{}", self.proxy.port);
        command.args(args).env("AWS_ENDPOINT_URL", endpoint).env("AWS_ALLOW_HTTP", "true");
        command.env("AWS_ACCESS_KEY_ID", "id").env("AWS_SECRET_ACCESS_KEY", "secret");
        command.env("AWS_REGION", "us-east-1");
        command
    }

    /// Past the proxy.
    #[track_caller]
    fn send(&self, method: &str, path: &str, bytes: &[u8]) -> Vec<u8> {
        let request = Request::new(method, &format!("/{}{path}", self.name), bytes);
        body(&request.answer(self.store).expect("an answer")).to_vec()
    }
}
