//! What users read on a terminal. All of it goes through here, because names and texts of files may hold anything.

use std::borrow::Cow;
use std::io::{self, Stderr, Write};

/// A text in which nothing can command a terminal: control characters but for new lines, and marks that change the direction of
/// writing, are written as JSON does, `\u001b`. So JSON stays what it is.
pub fn shown(text: &str) -> Cow<'_, str> {
    if text.chars().any(commands) {
        Cow::Owned(text.chars().flat_map(escaped).collect())
    } else {
        Cow::Borrowed(text)
    }
}

/// A name within a line: new lines are written as `\u000a` too.
pub fn name(text: &str) -> String {
    shown(text).replace('\n', "\\u000a")
}

fn commands(c: char) -> bool {
    let turns =
        matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || c.is_control() && c != '\n'
}

fn escaped(c: char) -> impl Iterator<Item = char> {
    // All of them are below 2^16.
    let escape = commands(c).then(|| format!("\\u{:04x}", u32::from(c)).chars().collect::<Vec<_>>());
    escape.unwrap_or_else(|| vec![c]).into_iter()
}

/// A message on stderr. Its further lines are indented, so that none of them looks like a message of its own.
pub fn tell(text: &str) {
    let text = shown(text);
    let mut lines = text.lines();
    let mut message = format!("mser3d: {}", lines.next().unwrap_or_default());
    for line in lines {
        message.push_str(if line.starts_with("  ") { "\n" } else { "\n  " });
        message.push_str(line);
    }
    message.push('\n');
    // Nobody is left to be told where stderr is closed.
    let _ = io::stderr().lock().write_all(message.as_bytes());
}

/// Stderr for a log, whose lines may hold anything too.
pub struct Log(Stderr);

impl Log {
    pub fn new() -> Self {
        Self(io::stderr())
    }
}

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // A line comes as a whole.
        let line = String::from_utf8_lossy(bytes);
        let (text, end) = line.strip_suffix('\n').map_or((&*line, ""), |text| (text, "\n"));
        self.0.write_all((name(text) + end).as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_commands_the_terminal() {
        assert_eq!(
            shown("a\u{1b}[31mb\u{9b}c\r\u{7f}\u{202e}\n"),
            "a\\u001b[31mb\\u009bc\\u000d\\u007f\\u202e\n"
        );
        assert!(matches!(shown("Größe 5 µm 日本\n"), Cow::Borrowed(_)));
        assert_eq!(name("a\nb"), "a\\u000ab");
        let json = serde_json::to_string("\u{9b}\u{1b}\n").unwrap();
        assert_eq!(serde_json::from_str::<String>(&shown(&json)).unwrap(), "\u{9b}\u{1b}\n");
    }
}
