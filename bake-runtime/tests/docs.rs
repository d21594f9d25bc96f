//! The page shows the example that is compiled.

#[test]
fn the_documented_program_is_the_example_and_short() {
    let (page, example) = (include_str!("../../docs/runtime.md"), include_str!("../examples/embed.rs"));
    // Without its own documentation.
    let program = example.split_once("\n\n").expect("a line of documentation first").1.trim_end();
    assert!(page.contains(program), "docs/runtime.md shows another program than bake-runtime/examples/embed.rs");
    let lines = program.lines().filter(|line| !line.trim().is_empty()).count();
    assert!(lines <= 32, "{lines} lines");
}
