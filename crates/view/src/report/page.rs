//! The page itself.

use super::attention::Attention;
use super::charts::{chart_data, charts};
use super::html::{Html, json_in_script};
use super::remarks::{drops, remarks};
use super::run::{Run, Thumbnail};
use super::scenes::{attention, scenes};
use super::summary::{provenance, quality, tiles};

const STYLE: &str = include_str!("../../report/style.css");
const PLOTS: &str = include_str!("../../report/plots.js");
const CHART: &str = include_str!("../../report/vendor/chart.umd.min.js");
const CHART_LICENSE: &str = include_str!("../../report/vendor/chart.LICENSE.md");

/// Nothing is fetched, nothing is sent.
const POLICY: &str = "default-src 'none'; script-src 'nonce-occlabel'; style-src 'unsafe-inline'; \
    img-src data:; base-uri 'none'; form-action 'none'";

/// One file that shows a run: no server, no network. What strays comes first; every number of a plot
/// stands in a table as well.
pub fn report_page(run: &Run, thumbnails: &[Thumbnail]) -> String {
    let order = Attention::of(run);
    let mut page = Html::default();
    head(&mut page, run);
    tiles(&mut page, run);
    notes(&mut page, run);
    attention(&mut page, run, &order, thumbnails);
    remarks(&mut page, run);
    charts(&mut page, run);
    quality(&mut page, run);
    scenes(&mut page, run, &order, thumbnails);
    drops(&mut page, run);
    provenance(&mut page, run);
    foot(&mut page, run, &order);
    page.finish()
}

fn head(page: &mut Html, run: &Run) {
    page.markup("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n");
    page.markup(&format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n"));
    page.markup("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    page.element("title", &format!("{} – occupancy labels", run.name)).line();
    page.markup("<style>\n").markup(STYLE).markup("</style></head><body><main>\n");
    page.markup("<header><p class=\"kind\">Report of a run</p>");
    page.element("h1", &run.name).markup("</header>\n");
}

fn notes(page: &mut Html, run: &Run) {
    for note in &run.notes {
        page.element("p class=\"note\"", note).line();
    }
}

fn foot(page: &mut Html, run: &Run, order: &Attention) {
    let data = json_in_script(&chart_data(run, order));
    // Where its map lies is nobody's business here.
    let chart = CHART.split("//# sourceMappingURL").next().unwrap_or(CHART);
    page.markup("<footer><p>Made by occlabel. Plots by Chart.js.</p>\n<details><summary>");
    page.markup("Licence of Chart.js</summary>").preformatted(CHART_LICENSE);
    page.markup("</details></footer></main>\n<script type=\"application/json\" id=\"data\">");
    page.markup(&data)
        .markup("</script>\n<script nonce=\"occlabel\">")
        .markup(chart)
        .markup("</script>\n<script nonce=\"occlabel\">\n");
    page.markup(PLOTS).markup("</script></body></html>\n");
}
