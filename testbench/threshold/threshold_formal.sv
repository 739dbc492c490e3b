// threshold_formal: properties of the handshake of threshold
//
// For formal tools only. All inputs are arbitrary. To prove the properties, run in a directory with
// the files of both folders:
//   $ yosys -q threshold_formal.ys
//   $ yosys-smtbmc -s z3 -t 7 threshold_formal.smt2
//   $ yosys-smtbmc -s z3 -i -t 7 threshold_formal.smt2
// or, with SymbiYosys,
//   $ sby -f threshold_formal.sby
//
// Generated files belong to their user, without conditions.

`default_nettype none

module threshold_formal (
    input  wire clk,
    input  wire rst_n,
    input  wire start,
    input  wire [20:0] cos_gamma,
    input  wire cos_gamma_write,
    input  wire [9:0] exponent,
    input  wire exponent_write,
    input  wire [7:0] red,
    input  wire red_write,
    input  wire [7:0] green,
    input  wire green_write,
    input  wire [7:0] blue,
    input  wire blue_write
);
    wire       valid;
    wire       busy;
    wire       done;
    wire [7:0] red_out;
    wire [7:0] green_out;
    wire [7:0] blue_out;

    threshold dut (
        .clk(clk),
        .rst_n(rst_n),
        .start(start),
        .cos_gamma(cos_gamma),
        .cos_gamma_write(cos_gamma_write),
        .exponent(exponent),
        .exponent_write(exponent_write),
        .red(red),
        .red_write(red_write),
        .green(green),
        .green_write(green_write),
        .blue(blue),
        .blue_write(blue_write),
        .valid(valid),
        .busy(busy),
        .done(done),
        .red_out(red_out),
        .green_out(green_out),
        .blue_out(blue_out)
    );

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    // The number of clocks since start.
    reg [2:0] age;
    always @(posedge clk) age <= busy ? age + 3'd1 : 3'd1;

    always @(posedge clk) if (!$initstate) begin
        if (!$past(rst_n)) begin
            // After a reset the core is idle, whatever the state before it was.
            assert (!busy && !done);
        end else if (!$past(busy)) begin
            // The core is idle until start and busy from the clock after it.
            assert (busy == $past(start));
        end else begin
            // The core is busy up to the clock of done.
            assert (busy == !$past(done));
        end
        if (done) assert (busy);
        if (valid) assert (busy);
        if ($past(rst_n)) begin
            // valid and done are high exactly in the clocks that the manifest promises.
            assert (valid == (busy && age == 3'd4));
            assert (done == (busy && age == 3'd4));
            if (busy) assert (age <= 3'd4);
        end
    end
endmodule

`default_nettype wire
