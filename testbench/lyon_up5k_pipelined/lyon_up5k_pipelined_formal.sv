// lyon_up5k_pipelined_formal: formal properties of the handshake of lyon_up5k_pipelined
//
// For formal tools only. All inputs are arbitrary. To prove the properties, run in a directory with
// the files of both folders:
//   $ yosys -q lyon_up5k_pipelined_formal.ys
//   $ yosys-smtbmc --unroll -s z3 -t 2 lyon_up5k_pipelined_formal.smt2
//   $ yosys-smtbmc --unroll -s z3 -i -t 2 lyon_up5k_pipelined_formal.smt2
// or, with SymbiYosys,
//   $ sby -f lyon_up5k_pipelined_formal.sby
//
// Generated files belong to their user, without conditions.

`default_nettype none

module lyon_up5k_pipelined_formal (
    input  wire clk,
    input  wire rst_n,
    input  wire in_valid,
    input  wire [17:0] dx,
    input  wire [17:0] dy,
    input  wire [17:0] dz,
    input  wire [3:0] shift,
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

    lyon_up5k_pipelined dut (
        .clk(clk),
        .rst_n(rst_n),
        .in_valid(in_valid),
        .dx(dx),
        .dy(dy),
        .dz(dz),
        .shift(shift),
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
    (* hierconn *) wire [19:1] \dut.valid ;
    (* hierconn *) wire \dut.slot ;
    wire [19:1] present = \dut.valid ;

    // A reference model of these bits. All points advance together, unless a result waits.
    wire moves = out_ready | ~out_valid;
    reg  turn;  // the core accepts points at 0
    always @(posedge clk) begin
        if (!rst_n) turn <= 0;
        else if (moves) turn <= (turn == 1) ? 0 : turn + 1;
    end
    reg  [19:1] queue;
    always @(posedge clk) begin
        if (!rst_n) queue <= 19'd0;
        else if (moves) queue <= {queue[18:1], (in_valid & (turn == 0))};
    end

    always @(posedge clk) if (!$initstate) begin
        // No point is lost or duplicated, and every point takes the same number of moves: out_valid
        // equals that of the reference model, whatever out_ready does.
        assert (present == queue);
        assert (out_valid == queue[19]);
        // The core accepts a point in slot 0 whenever no result waits.
        assert (\dut.slot  == turn);
        assert (in_ready == (moves & (turn == 0)));
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
