// ${ name }$: runs ${ bench }$ and writes the waveform of clocks ${ from }$ to ${ to }$ to ${ file }$

`default_nettype none

module ${ name }$;
    ${ bench }$ bench ();

    initial begin
        #${ begin }$;
        $dumpfile("${ file }$");
        $dumpvars(0, bench);
        #${ length }$;
        $display("FAIL ${ name }$: the window ends");
        $finish;
    end
endmodule

`default_nettype wire
