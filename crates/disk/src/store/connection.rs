//! A store that one talks to.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use object_store::aws::AmazonS3Builder;
use object_store::azure::MicrosoftAzureBuilder;
use object_store::gcp::GoogleCloudStorageBuilder;
use object_store::http::HttpBuilder;
use object_store::path::Path as Key;
use object_store::{
    BackoffConfig, ClientOptions, GetOptions, GetRange, ObjectStore, ObjectStoreExt,
    Result as StoreResult, RetryConfig,
};
use tokio::runtime::Runtime;

use super::catalog::Catalog;
use super::environment::check_variables;
use super::errors::io_error;
use super::expected::Expected;
use super::ranged_file::Piece;
use super::recent::Recent;
use crate::address::Address;

/// Threads that wait for the network.
const THREADS: usize = 2;

/// How long a request that fails is asked again, and after which pause at first. Stores under load refuse
/// requests for minutes.
const PATIENCE: Duration = Duration::from_secs(3 * 60);
const FIRST_PAUSE: Duration = Duration::from_millis(100);

/// A store, with what is known and expected of it.
#[derive(Debug)]
pub(crate) struct Connection {
    pub(crate) store: Arc<dyn ObjectStore>,
    /// Whether listings come in order and can begin anywhere.
    pub(crate) has_pages: bool,
    /// Whether a folder answers as a file does.
    pub(crate) has_folders: bool,
    catalogs: Mutex<Vec<Arc<Catalog>>>,
    pub(crate) expected: Mutex<Expected>,
    pub(crate) recent: Mutex<Recent>,
    /// Answers with bytes of objects, and these bytes.
    received: [AtomicU64; 2],
}

static CONNECTIONS: Mutex<BTreeMap<(String, String), Arc<Connection>>> =
    Mutex::new(BTreeMap::new());

static RUNTIME: LazyLock<Runtime> = LazyLock::new(|| {
    let mut builder = tokio::runtime::Builder::new_multi_thread();
    let builder = builder.worker_threads(THREADS).thread_name("store").enable_all();
    builder.build().expect("a thread can be started")
});

/// Waits for what the store answers.
pub(crate) fn wait_for<F: Future>(answer: F) -> F::Output {
    RUNTIME.block_on(answer)
}

/// Asks again, for a while, where an answer was cut: the library does so with the bytes of objects alone.
pub(crate) async fn patiently<T, F>(ask: impl Fn() -> F) -> StoreResult<T>
where
    F: Future<Output = StoreResult<T>>,
{
    let (begun, mut pause) = (Instant::now(), FIRST_PAUSE);
    loop {
        match ask().await {
            Err(error) if is_cut(&error) && begun.elapsed() < PATIENCE => {
                tokio::time::sleep(pause).await;
                pause *= 2;
            }
            answer => return answer,
        }
    }
}

/// The library tells it in words alone.
fn is_cut(error: &object_store::Error) -> bool {
    error.to_string().contains("response body")
}

/// Has it answer meanwhile.
pub(crate) fn begin<F>(answer: F) -> tokio::task::JoinHandle<F::Output>
where
    F: Future<Output: Send> + Send + 'static,
{
    RUNTIME.spawn(answer)
}

impl Connection {
    /// The connection to an address's store: one for all its objects.
    pub(crate) fn to(address: &Address) -> io::Result<Arc<Self>> {
        let name = (address.scheme.clone(), address.host.clone());
        let mut all = locked(&CONNECTIONS);
        if let Some(connection) = all.get(&name) {
            return Ok(connection.clone());
        }
        check_variables(std::env::vars_os())?;
        let store = connect(address).map_err(io_error)?;
        let has_pages = matches!(address.scheme.as_str(), "s3" | "s3a" | "gs");
        let has_folders = address.scheme.starts_with("http");
        let connection = Arc::new(Self { has_folders, ..Self::new(store, has_pages) });
        all.insert(name, connection.clone());
        Ok(connection)
    }

    pub(crate) fn new(store: Arc<dyn ObjectStore>, has_pages: bool) -> Self {
        Self {
            store,
            has_pages,
            has_folders: false,
            catalogs: Mutex::default(),
            expected: Mutex::default(),
            recent: Mutex::default(),
            received: Default::default(),
        }
    }

    /// The bytes of an object from one place up to another, or to its end.
    pub(crate) async fn piece(
        &self,
        key: &Key,
        from: u64,
        to: u64,
        version: Option<String>,
    ) -> StoreResult<Piece> {
        patiently(|| self.piece_at_once(key, from, to, version.clone())).await
    }

    async fn piece_at_once(
        &self,
        key: &Key,
        from: u64,
        to: u64,
        version: Option<String>,
    ) -> StoreResult<Piece> {
        let range = Some(GetRange::Bounded(from..to));
        let options = GetOptions { range, if_match: version, ..GetOptions::default() };
        let got = match self.store.get_opts(key, options).await {
            Err(error) if from == 0 && is_no_range(&error) => {
                return self.empty(key).await.ok_or(error);
            }
            got => got?,
        };
        let (all_bytes, version) = (got.meta.size, got.meta.e_tag.clone());
        let bytes = got.bytes().await?;
        self.received[0].fetch_add(1, Ordering::Relaxed);
        self.received[1].fetch_add(bytes.len() as u64, Ordering::Relaxed);
        Ok(Piece { from, all_bytes, version, bytes })
    }

    /// An object without bytes: stores have no range of it to give.
    async fn empty(&self, key: &Key) -> Option<Piece> {
        let meta = self.store.head(key).await.ok().filter(|meta| meta.size == 0)?;
        Some(Piece { from: 0, all_bytes: 0, version: meta.e_tag, bytes: Default::default() })
    }

    /// How many answers had bytes of objects, and how many these were.
    #[cfg(test)]
    pub(crate) fn received(&self) -> [u64; 2] {
        [0, 1].map(|at| self.received[at].load(Ordering::Relaxed))
    }

    /// What is remembered of the folder that does not change and holds this object, if there is one.
    pub(crate) fn catalog_of(&self, key: &Key) -> Option<Arc<Catalog>> {
        locked(&self.catalogs).iter().find(|catalog| catalog.holds(key)).cloned()
    }

    /// Nothing below this folder will change.
    pub(crate) fn remember(&self, folder: &Key) {
        if self.catalog_of(folder).is_none() {
            locked(&self.catalogs).push(Arc::new(Catalog::new(folder.clone())));
        }
    }
}

/// Whether a store, of which one is in memory, said that an object has no such bytes: the library tells
/// it in words alone.
fn is_no_range(error: &object_store::Error) -> bool {
    let told = error.to_string();
    ["416 Range Not Satisfiable", "Invalid range"].iter().any(|words| told.contains(words))
}

/// What another thread left is as good as ever: nothing panics amid a change.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Who may go in is told by the variables of the environment that the stores' own programs read.
fn connect(address: &Address) -> StoreResult<Arc<dyn ObjectStore>> {
    // Whichever was first stays.
    let _ = rustls::crypto::ring::default_provider().install_default();
    let Address { scheme, host, .. } = address;
    let (url, again) = (format!("{scheme}://{host}"), patience());
    Ok(match scheme.as_str() {
        "s3" | "s3a" => {
            Arc::new(AmazonS3Builder::from_env().with_url(url).with_retry(again).build()?)
        }
        "gs" => {
            Arc::new(GoogleCloudStorageBuilder::from_env().with_url(url).with_retry(again).build()?)
        }
        "az" | "abfs" | "abfss" => {
            Arc::new(MicrosoftAzureBuilder::from_env().with_url(url).with_retry(again).build()?)
        }
        "http" | "https" => {
            let options = ClientOptions::new().with_allow_http(scheme == "http");
            let builder = HttpBuilder::new().with_url(url).with_client_options(options);
            Arc::new(builder.with_retry(again).build()?)
        }
        _ => {
            let source = io::Error::new(ErrorKind::Unsupported, "no such store");
            return Err(object_store::Error::NotSupported { source: source.into() });
        }
    })
}

/// The time alone ends it.
fn patience() -> RetryConfig {
    let backoff = BackoffConfig { init_backoff: FIRST_PAUSE, ..BackoffConfig::default() };
    RetryConfig { backoff, max_retries: usize::MAX, retry_timeout: PATIENCE }
}
