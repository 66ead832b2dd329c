//! Which moments of a scene become keyframes.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap, HashSet};

use occlabel_core::{Fault, KeyframeSettings, KeyframeSource, Timestamp};

use super::captures::Capture;
use super::rows::{Sample, SampleData};
use super::table::{Row, Table};
use super::token::Token;
use crate::files::is_folder_name;
use crate::notes::Notes;

/// The reference lidar's key sweep of each sample: what tells a sample's time.
#[derive(Debug)]
pub(super) struct KeySweeps<'a> {
    /// By sample: a place among the scene's sweeps.
    sweep_of: HashMap<&'a Token, usize>,
    /// By sample: the time of its keyframe and its boxes.
    times: HashMap<&'a Token, Timestamp>,
}

/// A moment to be labelled.
#[derive(Debug)]
pub(super) struct Moment<'a> {
    /// The name of its output folder.
    pub(super) token: String,
    /// The place of its reference sweep among the scene's sweeps.
    pub(super) sweep: usize,
    pub(super) time: Timestamp,
    /// The sample, if the reference sweep is its key sweep.
    pub(super) sample: Option<&'a Token>,
}

/// The lidar that keyframes refer to.
///
/// # Errors
/// If the scene has no sweeps, or none of the lidar that is asked for.
pub(super) fn reference_lidar(
    settings: &KeyframeSettings,
    scene: &str,
    sweeps: &[Capture<'_>],
) -> Result<String, Fault> {
    let names: BTreeSet<&str> = sweeps.iter().map(|sweep| sweep.channel).collect();
    let names: Vec<String> = names.into_iter().map(str::to_owned).collect();
    settings.choose_lidar(&names).ok_or_else(|| {
        let expected = format!("sweeps of the reference lidar `{}`", settings.reference_lidar);
        let found = if names.is_empty() { "no sweeps".into() } else { names.join(", ") };
        Fault::new("reference-lidar", SampleData::FILE, expected, found).record(scene)
    })
}

impl<'a> KeySweeps<'a> {
    /// Finds the reference lidar's key sweep of each sample. A sample that has none is no keyframe,
    /// and its boxes go by the sample's own time, which is noted.
    pub(super) fn find(
        samples: &'a [Row<Sample>],
        sweeps: &[Capture<'a>],
        reference: &str,
        notes: &mut Notes,
    ) -> Self {
        let sweep_of = first_keys(sweeps, reference, notes);
        let time = |sample: &'a Row<Sample>| match sweep_of.get(&sample.token) {
            Some(&place) => sweeps[place].time,
            None => {
                let expected = format!("a key sweep of {reference}");
                let found = "none: no keyframe, its boxes go by its own time";
                notes.warn(sample.fault("key-sweep", expected, found));
                Timestamp::from_micros(sample.timestamp)
            }
        };
        let times = samples.iter().map(|sample| &sample.token).zip(samples.iter().map(time));
        Self { times: times.collect(), sweep_of }
    }

    /// Whether the sweep at a place is the key sweep of its sample.
    fn is_key(&self, place: usize, sweep: &Capture<'_>) -> bool {
        self.sweep_of.get(&sweep.row.sample_token) == Some(&place)
    }

    /// When the boxes of a sample stand; `None` for samples of other scenes.
    pub(super) fn time(&self, sample: &Token) -> Option<Timestamp> {
        self.times.get(sample).copied()
    }
}

/// By sample: the place of the reference lidar's first key sweep. A second one is noted.
fn first_keys<'a>(
    sweeps: &[Capture<'a>],
    reference: &str,
    notes: &mut Notes,
) -> HashMap<&'a Token, usize> {
    let is_key = |sweep: &Capture<'_>| sweep.row.is_key_frame && sweep.channel == reference;
    let mut first = HashMap::new();
    for (place, sweep) in sweeps.iter().enumerate().filter(|(_, sweep)| is_key(sweep)) {
        match first.entry(&sweep.row.sample_token) {
            Entry::Vacant(entry) => drop(entry.insert(place)),
            Entry::Occupied(_) => {
                let expected = format!("one key sweep of {reference} a sample");
                notes.warn(sweep.row.fault("key-sweep-repeated", expected, "a later one"));
            }
        }
    }
    first
}

/// The moments that the settings choose, in order of time.
///
/// # Errors
/// If a moment's token cannot name a folder, or names two.
pub(super) fn moments<'a>(
    settings: &KeyframeSettings,
    sweeps: &[Capture<'a>],
    reference: &str,
    keys: &KeySweeps<'a>,
) -> Result<Vec<Moment<'a>>, Fault> {
    let all = settings.source == KeyframeSource::Sweeps || keys.sweep_of.is_empty();
    let is_chosen = |&place: &usize| {
        sweeps[place].channel == reference && (all || keys.is_key(place, &sweeps[place]))
    };
    let chosen = (0..sweeps.len()).filter(is_chosen).step_by(settings.stride.max(1));
    let mut tokens = HashSet::new();
    chosen
        .map(|place| {
            let moment = moment(&sweeps[place], place, keys)?;
            match tokens.insert(moment.token.clone()) {
                true => Ok(moment),
                false => Err(token_fault(&sweeps[place], "a token of its own", &moment.token)),
            }
        })
        .collect()
}

fn moment<'a>(
    sweep: &Capture<'a>,
    place: usize,
    keys: &KeySweeps<'a>,
) -> Result<Moment<'a>, Fault> {
    let sample = keys.is_key(place, sweep).then_some(&sweep.row.sample_token);
    let token = sample.unwrap_or(&sweep.row.token).to_string();
    match is_folder_name(&token) {
        true => Ok(Moment { token, sweep: place, time: sweep.time, sample }),
        false => {
            Err(token_fault(sweep, "A-Z, a-z, 0-9, `.`, `_` and `-`, the first no dot", &token))
        }
    }
}

fn token_fault(sweep: &Capture<'_>, expected: &str, token: &str) -> Fault {
    sweep.row.fault("keyframe-token", expected, format!("`{token}`"))
}
