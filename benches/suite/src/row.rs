//! A line of the tables: what a unit of work costs.

use std::fmt;

use serde::Serialize;

use crate::clock::Cost;

/// Some work to measure, again and again.
pub(crate) struct Case<'a> {
    /// What it is.
    pub(crate) name: String,
    /// What is counted, and how many of them: a row each.
    pub(crate) units: Vec<(&'static str, u64)>,
    /// Does it once.
    pub(crate) run: Box<dyn FnMut() -> Cost + 'a>,
}

/// What it cost, every time.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Row {
    bench: &'static str,
    name: String,
    unit: &'static str,
    count: u64,
    /// CPU time a unit, nanoseconds, round by round.
    cpu_ns: Vec<f64>,
    /// The same on the wall.
    wall_ns: Vec<f64>,
}

impl<'a> Case<'a> {
    pub(crate) fn new(
        name: impl Into<String>,
        unit: &'static str,
        count: u64,
        run: impl FnMut() -> Cost + 'a,
    ) -> Self {
        Self { name: name.into(), units: vec![(unit, count)], run: Box::new(run) }
    }

    /// Told in another unit too.
    pub(crate) fn and(mut self, unit: &'static str, count: u64) -> Self {
        self.units.push((unit, count));
        self
    }

    fn rows(&self, bench: &'static str) -> Vec<Row> {
        let row = |&(unit, count)| Row::new(bench, &self.name, unit, count);
        self.units.iter().map(row).collect()
    }
}

/// Measures all cases in turns, so that all meet the same moods of the machine.
pub(crate) fn measure(bench: &'static str, mut cases: Vec<Case>, rounds: usize) -> Vec<Row> {
    let mut rows: Vec<Vec<Row>> = cases.iter().map(|case| case.rows(bench)).collect();
    for _ in 0..rounds {
        for (case, rows) in cases.iter_mut().zip(&mut rows) {
            let cost = (case.run)();
            rows.iter_mut().for_each(|row| row.add(cost));
        }
    }
    rows.concat()
}

/// Prints rows: a table for people to stderr, JSON lines to stdout.
pub(crate) fn print(rows: &[Row]) {
    for row in rows {
        eprintln!("{row}");
        println!("{}", serde_json::to_string(row).expect("a row of numbers and names"));
    }
}

/// Prints a single figure, as rows are printed.
pub(crate) fn tell(bench: &str, name: &str, unit: &str, value: f64) {
    eprintln!("{name:<36} {value:>11.3} {unit}");
    let line = serde_json::json!({ "bench": bench, "name": name, "unit": unit, "value": value });
    println!("{line}");
}

/// Prints how many times the CPU time of `other` a row takes, round by round.
pub(crate) fn tell_ratio(bench: &str, name: &str, row: &Row, other: &Row) {
    let ratios = row.cpu_ns.iter().zip(&other.cpu_ns).map(|(row, other)| row / other);
    let mut ratios: Vec<f64> = ratios.collect();
    ratios.sort_by(f64::total_cmp);
    let [least, .., most] = ratios[..] else { return tell(bench, name, "times", ratios[0]) };
    tell(bench, name, "times", ratios[ratios.len() / 2]);
    eprintln!("{:<36} {least:>11.3} to {most:.3}, {} rounds", "", ratios.len());
}

impl Row {
    fn new(bench: &'static str, name: &str, unit: &'static str, count: u64) -> Self {
        Self { bench, name: name.into(), unit, count, cpu_ns: vec![], wall_ns: vec![] }
    }

    fn add(&mut self, cost: Cost) {
        let unit_ns = 1e9 / self.count as f64;
        self.cpu_ns.push(cost.cpu_s * unit_ns);
        self.wall_ns.push(cost.wall_s * unit_ns);
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, unit, count, cpu_ns, .. } = self;
        let mut sorted = cpu_ns.clone();
        sorted.sort_by(f64::total_cmp);
        let (least, most) = (sorted[0], sorted[sorted.len() - 1]);
        let median = sorted[sorted.len() / 2];
        write!(f, "{name:<36} {median:>11.3} ns/{unit:<16} ({least:.3} to {most:.3}), {count} each")
    }
}
