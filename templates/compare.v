                if (${ output.name }$ !== ${ output.select }$) begin
                    ${ names.errors }$ = ${ names.errors }$ + 1;
                    if (${ names.errors }$ <= REPORTED) begin
                        $write("clock %0d, ", ${ names.clock }$);
                        ${ names.write_word }$;
                        $display(": ${ output.name }$ is %h, expected %h", ${ output.name }$, ${ output.select }$);
                    end
                end
