// quad_cosine_formal: what is proved of the handshake of quad_cosine
//
// For formal tools alone: every input is free. To prove it, from a directory that holds the files
// of both folders:
//   $ yosys -q quad_cosine_formal.ys
//   $ yosys-smtbmc --unroll -s z3 -t 4 quad_cosine_formal.smt2
//   $ yosys-smtbmc --unroll -s z3 -i -t 4 quad_cosine_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

module quad_cosine_formal (
    input  wire clk,
    input  wire rst_n,
    input  wire start,
    input  wire [7:0] amplitude,
    input  wire amplitude_write,
    input  wire [27:0] delta_zeta,
    input  wire delta_zeta_write,
    input  wire [27:0] zeta_start,
    input  wire zeta_start_write,
    input  wire [11:0] length,
    input  wire length_write,
    input  wire [9:0] exponent,
    input  wire exponent_write
);
    wire       valid;
    wire       busy;
    wire       done;
    wire       count;
    wire       accumulate;
    wire       write_angle;
    wire [7:0] intensity_out;

    quad_cosine dut (
        .clk(clk),
        .rst_n(rst_n),
        .start(start),
        .amplitude(amplitude),
        .amplitude_write(amplitude_write),
        .delta_zeta(delta_zeta),
        .delta_zeta_write(delta_zeta_write),
        .zeta_start(zeta_start),
        .zeta_start_write(zeta_start_write),
        .length(length),
        .length_write(length_write),
        .exponent(exponent),
        .exponent_write(exponent_write),
        .valid(valid),
        .busy(busy),
        .done(done),
        .count(count),
        .accumulate(accumulate),
        .write_angle(write_angle),
        .intensity_out(intensity_out)
    );

    // The initial set comes first; the state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    always @(posedge clk) if (!$initstate) begin
        if (!$past(rst_n)) begin
            // Idle after the initial set, whatever was before.
            assert (!busy && !done);
        end else if (!$past(busy)) begin
            // Idle until start, busy from the clock after it.
            assert (busy == $past(start));
        end else begin
            // Busy to the clock of done.
            assert (busy == !$past(done));
        end
        if (done) assert (busy);
    end
endmodule

`default_nettype wire
