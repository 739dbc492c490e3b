//! Shows progress bars for long work.

use std::fmt::Write;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle, WeakProgressBar};

use super::OutputOptions;

/// The width in characters from which a terminal shows the counts next to the bar.
const WIDE: usize = 100;

/// The largest and the smallest width of the bar alone, in characters.
const LONGEST: usize = 30;
const SHORTEST: usize = 5;

/// The width of the rest of a line: the name of the work, brackets, percentage or counts, rate, remaining time, blanks.
const BESIDE: usize = 44;
const BESIDE_WIDE: usize = 76;

/// The width if the width of the terminal is unknown.
const USUAL: u16 = 80;

/// The time to the first line about progress if standard error is no terminal but, for example, a log file.
const FIRST: Duration = Duration::from_secs(10);

/// The time between two lines about progress.
const EVERY: Duration = Duration::from_secs(60);

/// Returns a progress bar with the name `what` over `total` steps. It is hidden with `--json` or `--quiet`. If standard error is
/// no terminal, lines of text replace the bar: the first after ten seconds, and then one every minute.
pub fn bar(output: OutputOptions, total: u64, what: &str) -> ProgressBar {
    let is_hidden = output.quiet || !output.is_for_people();
    let target = if is_hidden {
        ProgressDrawTarget::hidden()
    } else {
        // Draws nothing when standard error is not a terminal.
        ProgressDrawTarget::stderr()
    };
    let without = !is_hidden && !console::Term::stderr().is_term();
    let width = match console::Term::stderr().size_checked() {
        Some((_, width)) => width,
        None => USUAL,
    };
    let bar = styled(ProgressBar::with_draw_target(Some(total), target), usize::from(width), what);
    if without {
        let (watched, what) = (bar.downgrade(), what.to_owned());
        std::thread::spawn(move || told(&watched, &what));
    }
    bar
}

/// Prints the lines that replace a bar, until the bar is finished or dropped.
fn told(bar: &WeakProgressBar, what: &str) {
    let mut wait = FIRST;
    loop {
        std::thread::sleep(wait);
        wait = EVERY;
        let Some(bar) = bar.upgrade() else { return };
        if bar.is_finished() {
            return;
        }
        let (done, all) = (bar.position(), bar.length().unwrap_or(0));
        match remaining(bar.elapsed(), done, all) {
            Some(left) => eprintln!("{what}: {done} of {all}, about {left} left"),
            None => eprintln!("{what}: {done} of {all}"),
        }
    }
}

/// Gives the bar a form that fits into `width` characters.
fn styled(bar: ProgressBar, width: usize, what: &str) -> ProgressBar {
    if let Ok(style) = ProgressStyle::with_template(&template(width)) {
        let rate = |state: &ProgressState, out: &mut dyn Write| {
            let _ = write!(out, "{}/s", rounded(state.per_sec()));
        };
        let left = |state: &ProgressState, out: &mut dyn Write| {
            let left = remaining(state.elapsed(), state.pos(), state.len().unwrap_or(0));
            let _ = write!(out, "{}", left.unwrap_or_default());
        };
        bar.set_style(style.progress_chars("=> ").with_key("rate", rate).with_key("left", left));
    }
    bar.set_message(what.to_owned());
    bar
}

fn template(width: usize) -> String {
    if width >= WIDE {
        let bar = width.saturating_sub(BESIDE_WIDE).clamp(SHORTEST, LONGEST);
        format!("{{msg:24!}} [{{bar:{bar}}}] {{human_pos}}/{{human_len}} {{rate}} {{left}}")
    } else {
        let bar = width.saturating_sub(BESIDE).clamp(SHORTEST, LONGEST);
        format!("{{msg:20!}} [{{bar:{bar}}}] {{percent:>3}} % {{rate}} {{left}}")
    }
}

/// Formats a number with three digits, and with k, M or G for thousands, millions or billions. For example, 1234.5678 is `1.23k`.
fn rounded(number: f64) -> String {
    let (size, unit) = match number {
        1e9.. => (1e9, "G"),
        1e6.. => (1e6, "M"),
        1e3.. => (1e3, "k"),
        _ => (1.0, ""),
    };
    let scaled = number / size;
    let decimals = match scaled {
        100.0.. => 0,
        10.0.. => 1,
        _ => 2,
    };
    format!("{scaled:.decimals$}{unit}")
}

/// Returns the remaining time at the average pace so far. For example, 10 of 40 steps in 2 seconds leave `6 s`. Returns `None`
/// before the first step and after the last one.
fn remaining(elapsed: Duration, done: u64, all: u64) -> Option<String> {
    if done == 0 || done >= all {
        return None;
    }
    let exact = elapsed.as_secs_f64() * (all - done) as f64 / done as f64;
    let seconds = exact.ceil() as u64;
    Some(match seconds {
        ..60 => format!("{seconds} s"),
        60..3600 => format!("{} min {} s", seconds / 60, seconds % 60),
        _ => format!("{} h {} min", seconds / 3600, seconds % 3600 / 60),
    })
}

#[cfg(test)]
mod tests {
    use std::io;
    use std::sync::{Arc, Mutex};

    use indicatif::TermLike;

    use super::*;

    #[test]
    fn rates_have_three_digits() {
        for (number, text) in [
            (0.12345, "0.12"),
            (3.0, "3.00"),
            (12.3456, "12.3"),
            (870.4321, "870"),
            (1234.5678, "1.23k"),
            (3_456_789.0, "3.46M"),
            (12_345_678_901.0, "12.3G"),
        ] {
            assert_eq!(rounded(number), text);
        }
    }

    #[test]
    fn what_is_left_is_told_from_the_first_step_to_the_last() {
        let after = |seconds, done| remaining(Duration::from_secs_f64(seconds), done, 40);
        assert_eq!(after(3.0, 0), None);
        assert_eq!(after(2.0, 10).as_deref(), Some("6 s"));
        // It is never 0 s while steps remain.
        assert_eq!(after(0.001, 39).as_deref(), Some("1 s"));
        assert_eq!(after(100.0, 10).as_deref(), Some("5 min 0 s"));
        assert_eq!(after(7200.0, 20).as_deref(), Some("2 h 0 min"));
        assert_eq!(after(9.0, 40), None);
    }

    /// A terminal that records everything that is written to it.
    #[derive(Clone, Debug)]
    struct Paper(u16, Arc<Mutex<Vec<String>>>);

    impl TermLike for Paper {
        fn width(&self) -> u16 {
            self.0
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(text)
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.1.lock().expect("one thread").push(text.trim_end().to_owned());
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_line_fits_the_terminal() {
        for width in [50, 60, 80, 99, 100, 120, 200] {
            let lines = Arc::new(Mutex::new(Vec::new()));
            let paper = Box::new(Paper(u16::try_from(width).expect("narrow"), lines.clone()));
            let target = ProgressDrawTarget::term_like(paper);
            let bar = ProgressBar::with_draw_target(Some(123_456_789_012), target);
            // The text is longer than the line, so a line that is not cut shows its whole length.
            let bar = styled(bar, width, "Golden model against simulation, every operand");
            bar.set_position(98_765_432_109);
            bar.tick();
            let lines = lines.lock().expect("one thread");
            let line = lines.iter().find(|line| line.contains('[')).expect("a line");
            assert!(line.chars().count() <= width, "{width}: {line}");
            assert!(line.contains("/s"), "{width}: {line}");
        }
    }
}
