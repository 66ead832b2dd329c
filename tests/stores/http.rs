//! Requests of HTTP/1.1 by hand, one a connection.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::TcpStream;

/// The server looks who signed, not how.
const SIGNED: &str = "Authorization: AWS4-HMAC-SHA256 Credential=id/20260101/us-east-1/s3/aws4_request, \
     SignedHeaders=host, Signature=none";

/// A request as it was read, or is to be sent.
#[derive(Clone, Debug)]
pub(crate) struct Request {
    /// `PUT /bucket/key HTTP/1.1`.
    pub(crate) line: String,
    /// Without their line ends.
    headers: Vec<String>,
    body: Vec<u8>,
}

impl Request {
    /// A request with a body.
    pub(crate) fn new(method: &str, path: &str, body: &[u8]) -> Self {
        let headers = [SIGNED, "Host: 127.0.0.1", &format!("Content-Length: {}", body.len())];
        let headers = headers.map(str::to_owned).to_vec();
        Self { line: format!("{method} {path} HTTP/1.1"), headers, body: body.to_vec() }
    }

    /// Reads one, with its body; none if the other side is gone.
    pub(crate) fn read(from: &TcpStream) -> io::Result<Option<Self>> {
        let mut from = BufReader::new(from);
        let mut lines = Vec::new();
        loop {
            let mut line = String::new();
            if from.read_line(&mut line)? == 0 {
                return Ok(None);
            }
            match line.trim_end() {
                "" => break,
                line => lines.push(line.to_owned()),
            }
        }
        let line = lines.remove(0);
        let length = lines.iter().find_map(|line| {
            line.to_ascii_lowercase().strip_prefix("content-length:")?.trim().parse().ok()
        });
        let mut body = vec![0; length.unwrap_or(0)];
        from.read_exact(&mut body)?;
        Ok(Some(Self { line, headers: lines, body }))
    }

    /// Sends it to a port of this machine, and gives the whole answer.
    pub(crate) fn answer(&self, port: u16) -> io::Result<Vec<u8>> {
        let mut stream = TcpStream::connect(("127.0.0.1", port))?;
        let is_kept = |line: &&String| !line.to_ascii_lowercase().starts_with("connection:");
        let headers: String =
            self.headers.iter().filter(is_kept).map(|line| format!("{line}\r\n")).collect();
        let head = format!("{}\r\n{headers}Connection: close\r\n\r\n", self.line);
        stream.write_all(&[head.as_bytes(), &self.body].concat())?;
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer)?;
        Ok(answer)
    }
}

/// The body of an answer, which has to be one of success.
#[track_caller]
pub(crate) fn body(answer: &[u8]) -> &[u8] {
    let end = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n").expect("a head");
    let head = String::from_utf8_lossy(&answer[..end]);
    assert!(head.starts_with("HTTP/1.1 2"), "{}", String::from_utf8_lossy(answer));
    &answer[end + 4..]
}
