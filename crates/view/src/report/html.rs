//! HTML, in which texts of logs are never markup.

use occlabel_core::printable;

/// A page that grows.
#[derive(Default)]
pub(crate) struct Html {
    text: String,
}

impl Html {
    /// Adds markup of our own.
    pub(crate) fn markup(&mut self, markup: &str) -> &mut Self {
        self.text.push_str(markup);
        self
    }

    /// Adds a text, whatever is in it.
    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        self.text.push_str(&escaped(text));
        self
    }

    /// Adds an element that holds a text. `open` is its name and attributes.
    pub(crate) fn element(&mut self, open: &str, text: &str) -> &mut Self {
        let name = open.split(' ').next().unwrap_or(open);
        self.markup(&format!("<{open}>")).text(text).markup(&format!("</{name}>"))
    }

    /// Adds the lines of a text, as they stand.
    pub(crate) fn preformatted(&mut self, text: &str) -> &mut Self {
        self.markup("<pre>");
        for line in text.lines() {
            self.text(line).line();
        }
        self.markup("</pre>")
    }

    /// Adds a line's end.
    pub(crate) fn line(&mut self) -> &mut Self {
        self.markup("\n")
    }

    /// Adds a table of texts.
    pub(crate) fn table(&mut self, class: &str, heads: &[&str], rows: &[Vec<String>]) {
        self.markup(&format!("<div class=\"scroll\"><table class=\"{class}\"><thead><tr>"));
        for head in heads {
            self.element("th", head);
        }
        self.markup("</tr></thead><tbody>\n");
        for row in rows {
            self.markup("<tr>");
            for cell in row {
                self.element("td", cell);
            }
            self.markup("</tr>\n");
        }
        self.markup("</tbody></table></div>\n");
    }

    /// What has grown.
    pub(crate) fn finish(self) -> String {
        self.text
    }
}

/// A text as HTML shows it, in elements and in quoted attributes. Control characters are spelt out, and
/// so are those that turn the direction of writing.
pub(crate) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in printable(text).chars() {
        match c {
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '&' => safe.push_str("&amp;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => safe.extend(c.escape_unicode()),
            c => safe.push(c),
        }
    }
    safe
}

/// JSON that no script element ends early in.
pub(crate) fn json_in_script(json: &serde_json::Value) -> String {
    json.to_string()
        .replace('<', "\\u003c")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_never_markup() {
        assert_eq!(escaped("<b a='\"'>&"), "&lt;b a=&#39;&quot;&#39;&gt;&amp;");
        assert_eq!(escaped("a\nb\u{202e}c"), "a\\nb\\u{202e}c");
        let json = serde_json::json!(["</script><!--"]);
        assert_eq!(json_in_script(&json), "[\"\\u003c/script>\\u003c!--\"]");
    }
}
