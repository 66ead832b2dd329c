//! A server between the program and the store, which does what networks do.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use crate::http::Request;

/// What becomes of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Fate {
    /// It is passed on, and its answer back.
    Passed,
    /// The store has an error of its own.
    Error500,
    /// The store has too much to do.
    Busy503,
    /// The connection is gone before the request is passed on.
    Dropped,
    /// The store does it, and the answer is lost.
    AnswerLost,
    /// The answer ends in its midst.
    AnswerCut,
    /// The answer trickles in.
    Slow,
}

/// All that may go wrong.
pub(crate) const FAULTS: [Fate; 6] =
    [Fate::Error500, Fate::Busy503, Fate::Dropped, Fate::AnswerLost, Fate::AnswerCut, Fate::Slow];

/// Passes requests on to a store's port.
pub(crate) struct Proxy {
    pub(crate) port: u16,
    /// What was asked for, and what became of it.
    log: Arc<Mutex<Vec<(String, Fate)>>>,
}

impl Proxy {
    /// Stands before a store. Of a hundred requests about so many go wrong, always the same.
    pub(crate) fn before(store: u16, faults_in_100: u64) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let log = Arc::<Mutex<Vec<_>>>::default();
        let kept = log.clone();
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let log = log.clone();
                // Who hung up, on either side, will ask again.
                thread::spawn(move || serve(&stream, store, faults_in_100, &log));
            }
        });
        Self { port, log: kept }
    }

    /// How many requests met each fate.
    pub(crate) fn fates(&self) -> BTreeMap<Fate, usize> {
        let mut counts = BTreeMap::new();
        for (_, fate) in self.log.lock().unwrap().iter() {
            *counts.entry(*fate).or_default() += 1;
        }
        counts
    }

    /// How many requests began so.
    pub(crate) fn count(&self, beginning: &str) -> usize {
        let log = self.log.lock().unwrap();
        log.iter().filter(|(line, _)| line.starts_with(beginning)).count()
    }
}

fn serve(
    mut to: &TcpStream,
    store: u16,
    faults_in_100: u64,
    log: &Mutex<Vec<(String, Fate)>>,
) -> io::Result<()> {
    let Some(request) = Request::read(to)? else { return Ok(()) };
    let fate = {
        let mut log = log.lock().unwrap();
        let fate = fate(log.len() as u64, faults_in_100);
        log.push((request.line.clone(), fate));
        fate
    };
    let answer = match fate {
        Fate::Dropped => return Ok(()),
        Fate::Error500 => refusal("500 Internal Server Error"),
        Fate::Busy503 => refusal("503 Slow Down"),
        _ => request.answer(store)?,
    };
    match fate {
        Fate::AnswerLost => Ok(()),
        Fate::AnswerCut => to.write_all(&answer[..answer.len() * 2 / 3]),
        Fate::Slow => answer.chunks(answer.len().div_ceil(8)).try_for_each(|piece| {
            thread::sleep(Duration::from_millis(20));
            to.write_all(piece)
        }),
        _ => to.write_all(&answer),
    }
}

fn refusal(status: &str) -> Vec<u8> {
    format!("HTTP/1.1 {status}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n").into_bytes()
}

/// By the number of the request alone, scattered by splitmix64 [Steele et al. 2014].
fn fate(number: u64, faults_in_100: u64) -> Fate {
    let mut z = (number + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    match z % 100 < faults_in_100 {
        true => FAULTS[(z / 100 % FAULTS.len() as u64) as usize],
        false => Fate::Passed,
    }
}
