//! Prints which tests this run of `cargo test` leaves out: without the feature `outside-tools`, the tests that run outside
//! tools.

fn main() {
    if cfg!(feature = "outside-tools") {
        println!("all tests: those that need no tool but Glint, and those that run outside tools");
    } else {
        println!(
            "LEFT OUT: the tests that run simulators, synthesis, provers and Python. \
             `bash tools/test` installs the tools and runs every test."
        );
    }
}
