// cosine_squared_formal: properties of the handshake of cosine_squared
//
// For formal tools only. All inputs are arbitrary. To prove the properties, run in a directory with
// the files of both folders:
//   $ yosys -q cosine_squared_formal.ys
//   $ yosys-smtbmc --unroll -s z3 -t 8 cosine_squared_formal.smt2
//   $ yosys-smtbmc --unroll -s z3 -i -t 8 cosine_squared_formal.smt2
// or, with SymbiYosys,
//   $ sby -f cosine_squared_formal.sby
//
// Generated files belong to their user, without conditions.

`default_nettype none

module cosine_squared_formal (
    input  wire clk,
    input  wire rst_n,
    input  wire start,
    input  wire [7:0] amplitude,
    input  wire amplitude_write,
    input  wire [29:0] delta_zeta,
    input  wire delta_zeta_write,
    input  wire [29:0] zeta_start,
    input  wire zeta_start_write,
    input  wire [11:0] length,
    input  wire length_write
);
    wire       valid;
    wire       busy;
    wire       done;
    wire       count;
    wire       accumulate;
    wire       write_angle;
    wire [7:0] intensity_out;

    cosine_squared dut (
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
        .valid(valid),
        .busy(busy),
        .done(done),
        .count(count),
        .accumulate(accumulate),
        .write_angle(write_angle),
        .intensity_out(intensity_out)
    );

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    // The number of clocks since start.
    reg [13:0] age;
    always @(posedge clk) age <= busy ? age + 14'd1 : 14'd1;

    // The address of the current microinstruction, and the counters of loops.
    (* hierconn *) wire [2:0] \dut.control.word_address ;
    wire [2:0] word = \dut.control.word_address ;
    (* hierconn *) wire [11:0] \dut.datapath.intervals ;
    wire [11:0] intervals = \dut.datapath.intervals ;

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
        if (busy) begin
            // Every computation ends in time: the clocks so far, plus the most clocks from the
            // current microinstruction to the end, are within the promised number.
            assert (age <= 14'h1004);
            case (word)
                3'd0: assert (age + 14'h1003 <= 14'h1004);
                3'd1: assert (age + 14'h1002 <= 14'h1004);
                3'd2: assert (age + intervals + 14'd2 <= 14'h1004);
                3'd3: assert (age + 14'd1 <= 14'h1004);
                3'd4: assert (age <= 14'h1004);
            endcase
        end
        // Every computation ends with a result.
        if (done) assert (valid);
        // From the clock that the manifest promises to the end, every clock has a result.
        assert (valid == (busy && age >= 14'd4));
    end
endmodule

`default_nettype wire
