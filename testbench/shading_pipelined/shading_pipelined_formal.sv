// shading_pipelined_formal: what is proved of the handshake of shading_pipelined
//
// For formal tools alone: every input is free. To prove it, from a directory that holds the files
// of both folders:
//   $ yosys -q shading_pipelined_formal.ys
//   $ yosys-smtbmc --unroll -s z3 -t 2 shading_pipelined_formal.smt2
//   $ yosys-smtbmc --unroll -s z3 -i -t 2 shading_pipelined_formal.smt2
// or, with SymbiYosys,
//   $ sby -f shading_pipelined_formal.sby
//
// Generated files belong to their user, without conditions.

`default_nettype none

module shading_pipelined_formal (
    input  wire clk,
    input  wire rst_n,
    input  wire in_valid,
    input  wire [15:0] nx,
    input  wire [15:0] ny,
    input  wire [15:0] nz,
    input  wire [15:0] lx,
    input  wire [15:0] ly,
    input  wire [15:0] lz,
    input  wire [15:0] hx,
    input  wire [15:0] hy,
    input  wire [15:0] hz,
    input  wire [9:0] exponent,
    input  wire [7:0] ambient_red,
    input  wire [7:0] ambient_green,
    input  wire [7:0] ambient_blue,
    input  wire [7:0] diffuse_red,
    input  wire [7:0] diffuse_green,
    input  wire [7:0] diffuse_blue,
    input  wire [7:0] specular_red,
    input  wire [7:0] specular_green,
    input  wire [7:0] specular_blue,
    input  wire out_ready
);
    wire       in_ready;
    wire       out_valid;
    wire [7:0] red_out;
    wire [7:0] green_out;
    wire [7:0] blue_out;

    shading_pipelined dut (
        .clk(clk),
        .rst_n(rst_n),
        .in_valid(in_valid),
        .nx(nx),
        .ny(ny),
        .nz(nz),
        .lx(lx),
        .ly(ly),
        .lz(lz),
        .hx(hx),
        .hy(hy),
        .hz(hz),
        .exponent(exponent),
        .ambient_red(ambient_red),
        .ambient_green(ambient_green),
        .ambient_blue(ambient_blue),
        .diffuse_red(diffuse_red),
        .diffuse_green(diffuse_green),
        .diffuse_blue(diffuse_blue),
        .specular_red(specular_red),
        .specular_green(specular_green),
        .specular_blue(specular_blue),
        .out_ready(out_ready),
        .in_ready(in_ready),
        .out_valid(out_valid),
        .red_out(red_out),
        .green_out(green_out),
        .blue_out(blue_out)
    );

    // The reset comes first; the state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    // Which stage of the pipeline has a point.
    (* hierconn *) wire [21:1] \dut.valid ;
    wire [21:1] present = \dut.valid ;

    // The same for a queue beside it: all points in it move together, unless a result waits.
    wire moves = out_ready | ~out_valid;
    reg  [21:1] queue;
    always @(posedge clk) begin
        if (!rst_n) queue <= 21'd0;
        else if (moves) queue <= {queue[20:1], in_valid};
    end

    always @(posedge clk) if (!$initstate) begin
        // No point is lost, none is doubled, and none comes sooner or later than the stages let it:
        // out_valid follows from the points that were taken, whatever out_ready is.
        assert (present == queue);
        assert (out_valid == queue[21]);
        // A point is taken whenever no result waits.
        assert (in_ready == moves);
        // A result that waits stays as it is.
        if ($past(rst_n && out_valid && !out_ready)) begin
            assert (out_valid);
            assert ($stable(red_out));
            assert ($stable(green_out));
            assert ($stable(blue_out));
        end
    end
endmodule

`default_nettype wire
