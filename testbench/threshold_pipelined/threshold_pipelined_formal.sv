// threshold_pipelined_formal: formal properties of the handshake of threshold_pipelined
//
// For formal tools only. All inputs are arbitrary. To prove the properties, run in a directory with
// the files of both folders:
//   $ yosys -q threshold_pipelined_formal.ys
//   $ yosys-smtbmc --unroll -s z3 -t 2 threshold_pipelined_formal.smt2
//   $ yosys-smtbmc --unroll -s z3 -i -t 2 threshold_pipelined_formal.smt2
// or, with SymbiYosys,
//   $ sby -f threshold_pipelined_formal.sby
//
// Generated files belong to their user, without conditions.

`default_nettype none

module threshold_pipelined_formal (
    input  wire clk,
    input  wire rst_n,
    input  wire in_valid,
    input  wire [20:0] cos_gamma,
    input  wire [9:0] exponent,
    input  wire [7:0] red,
    input  wire [7:0] green,
    input  wire [7:0] blue,
    input  wire out_ready
);
    wire       in_ready;
    wire       out_valid;
    wire [7:0] red_out;
    wire [7:0] green_out;
    wire [7:0] blue_out;

    threshold_pipelined dut (
        .clk(clk),
        .rst_n(rst_n),
        .in_valid(in_valid),
        .cos_gamma(cos_gamma),
        .exponent(exponent),
        .red(red),
        .green(green),
        .blue(blue),
        .out_ready(out_ready),
        .in_ready(in_ready),
        .out_valid(out_valid),
        .red_out(red_out),
        .green_out(green_out),
        .blue_out(blue_out)
    );

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    // The stages that hold a point.
    (* hierconn *) wire [9:1] \dut.valid ;
    wire [9:1] present = \dut.valid ;

    // A reference model of these bits. All points advance together, unless a result waits.
    wire moves = out_ready | ~out_valid;
    reg  [9:1] queue;
    always @(posedge clk) begin
        if (!rst_n) queue <= 9'd0;
        else if (moves) queue <= {queue[8:1], in_valid};
    end

    always @(posedge clk) if (!$initstate) begin
        // No point is lost or duplicated, and every point takes the same number of moves: out_valid
        // equals that of the reference model, whatever out_ready does.
        assert (present == queue);
        assert (out_valid == queue[9]);
        // The core accepts a point whenever no result waits.
        assert (in_ready == moves);
        // A waiting result stays unchanged.
        if ($past(rst_n && out_valid && !out_ready)) begin
            assert (out_valid);
            assert ($stable(red_out));
            assert ($stable(green_out));
            assert ($stable(blue_out));
        end
    end
endmodule

`default_nettype wire
